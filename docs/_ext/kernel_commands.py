"""What kernels of the pages begin with: cells of commands print in one piece, and may not fail."""

import subprocess

from IPython.core.magic import register_cell_magic


@register_cell_magic
def sh(_: str, cell: str) -> None:
    """Run a cell of commands; the magic of IPython cuts what is printed into pieces."""
    done = subprocess.run(["sh", "-ec", cell], capture_output=True, text=True, check=False)
    print(done.stdout + done.stderr, end="")
    if done.returncode != 0:
        raise RuntimeError(f"the commands ended with {done.returncode}")
