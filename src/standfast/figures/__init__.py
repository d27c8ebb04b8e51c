"""Arrays to matplotlib: each function draws into the axes that it is given.

No model is evaluated and nothing is read here. Curves differ in line style and are labelled where
they run, so that a figure reads in grey; the few colours are those of Okabe & Ito, which are safe
for colour-blind readers.
"""
