"""From a tile of a study to arrays: the only place with ``jit`` and ``vmap``."""
