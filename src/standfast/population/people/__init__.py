"""Who is simulated: people of files or built in, their stiffness, and how they are sampled."""
