"""The standing person as a mechanism: joints, energies, A and C, equations of motion."""
