"""The page and its answers on this machine alone: 127.0.0.1, with a random token.

Every request must name this server as its host, which a page of another site that has its name
point here cannot; none may come from another origin; and each carries the token, that for the page
in its address, all others in a header.
No path or name of a file comes from the browser.
"""

import asyncio
import signal
import socket
from collections.abc import Callable

from tornado.httpserver import HTTPServer
from tornado.web import Application

from standfast.errors import InputError
from standfast.explore.answers import ANSWERS, ELSEWHERE
from standfast.explore.served import ADDRESS, Served

# What is larger Tornado refuses itself, before it is in memory.
BUFFER_BYTES = 2**23


def application(served: Served) -> Application:
    """Return the addresses and who answers them."""
    of = {"served": served}
    return Application(
        [(path, answer, of) for path, answer in ANSWERS.items()],
        default_handler_class=ELSEWHERE,
        default_handler_args=of,
        log_function=lambda _: None,
    )


def listening(port: int) -> socket.socket:
    """Return a socket on a port of this machine, 0: any that is free.

    Raises
    ------
    InputError
        if the port is taken.
    """
    found = socket.socket()
    found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        found.bind((ADDRESS, port))
        found.listen()
    except OSError as error:
        found.close()
        raise InputError(
            f"--port {port} cannot be had ({error.strerror}); give another, or none for any that "
            "is free"
        ) from None
    found.setblocking(False)
    return found


def serve(served: Served, at: socket.socket, ready: Callable[[], None]) -> None:
    """Answer on a socket until Ctrl-C; ``ready`` is called once that is so."""
    try:
        asyncio.run(_serve(served, at, ready))
    finally:
        served.close()


def answering(served: Served, at: socket.socket) -> HTTPServer:
    """Let the running loop answer on a socket."""
    served.port = at.getsockname()[1]
    server = HTTPServer(application(served), max_body_size=BUFFER_BYTES)
    server.add_socket(at)
    return server


async def _serve(served: Served, at: socket.socket, ready: Callable[[], None]) -> None:
    stop = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, stop.set)
    server = answering(served, at)
    ready()
    await stop.wait()
    server.stop()
