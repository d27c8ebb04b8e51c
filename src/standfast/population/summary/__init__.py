"""What is answered: estimates with intervals, sensitivity, the file."""
