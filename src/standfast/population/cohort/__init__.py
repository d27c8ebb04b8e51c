"""What is simulated: one person after the other, counted into histograms."""
