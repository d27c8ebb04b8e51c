"""How far a person sways whose joints are disturbed by noise: pure functions of persons."""
