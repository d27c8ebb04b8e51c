import jax

# The package touches no flag of JAX; a program that traces it asks for double precision itself.
jax.config.update("jax_enable_x64", True)
