"""A viser server that only this machine can talk to."""

from __future__ import annotations  # viser is loaded when a server is made

import contextlib
import errno
import http
import socket
import threading
from collections.abc import AsyncIterator, Callable, Iterator
from importlib.util import find_spec
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from six_wheel.kinematics.errors import ArgumentTypeError, shown
from six_wheel.view.export import client_page

if TYPE_CHECKING:
    import viser

HOST = "127.0.0.1"
INSTALL = 'pip install "six-wheel[view]"'
LOOPBACK = ("127.0.0.1", "localhost", "::1")
# [s] a server with a browser on it takes up to 6 s to wind down, in a thread that may be left
STOP_TIME = 0.8
_making = threading.Lock()  # while one server is made, the function that opens sockets is a guarded one


def require() -> None:
    """Fail with the install line where the extra is missing."""
    for name in ("viser", "trimesh"):
        if find_spec(name) is None:
            raise ModuleNotFoundError(f"the view needs {name}: {INSTALL}", name=name)


def free_port(port: int) -> None:
    """Fail unless the port can be opened on the loopback. Raises `ValueError` if it is no port, is taken, or
    may not be opened."""
    is_whole = isinstance(port, int) and not isinstance(port, bool)
    if not is_whole or not 0 <= port <= 65535:
        kind = ValueError if is_whole else ArgumentTypeError
        raise kind(f"port must be from 0 to 65535, got {shown(port)}")
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((HOST, port))
        except OSError as error:
            taken = error.errno == errno.EADDRINUSE
            why = "is taken" if taken else f"cannot be opened ({error.strerror})"
            raise ValueError(f"port {port} {why}; --port 0 takes a free one") from None


def is_local(hosts: list[str], origins: list[str]) -> bool:
    """True if a request comes from a page of this very server, by its headers.

    A name that was made to lead to the loopback is no name of it, and a page of another site or of another
    server of this machine has another origin. Requests without an origin are those of programs and of the
    address line.
    """
    if len(hosts) != 1 or len(origins) > 1:
        return False
    try:
        host = urlsplit(f"//{hosts[0]}")
        origin = urlsplit(origins[0]) if origins else None
        ports = [host.port, origin.port if origin else host.port]
    except ValueError:  # no number for a port
        return False
    names = [host.hostname, origin.hostname if origin else host.hostname]
    return all(name in LOOPBACK for name in names) and ports[0] == ports[1]


def open_server(port: int | None) -> viser.ViserServer:
    """A server on the loopback, guarded by `is_local`, without a way to be shared publicly.

    Port 0 takes a free one, None opens none: nobody is served, and the scene can be saved. Raises
    `ValueError` if the port cannot be had. Raises `RuntimeError` if this version of viser opens its socket in
    another way, so that it cannot be guarded.
    """
    require()
    if port is not None:
        free_port(port)
    import viser
    import websockets.asyncio.server as sockets

    page = client_page()

    class LocalServer(viser.ViserServer):
        def request_share_url(self, verbose: bool = True) -> str | None:
            return None

        def disconnect_share_url(self) -> None:
            return None

    guarded: list[bool] = []
    with _making, _silent():
        opened = sockets.serve

        def serve(handler: Any, host: Any, bound: Any, **options: Any) -> Any:
            guarded.append(True)
            if port is None:
                return _nobody()
            options["process_request"] = _guard(options.get("process_request"), page)
            return opened(handler, host, bound, **options)

        sockets.serve = serve
        try:
            server = LocalServer(host=HOST, port=port or 0, verbose=False, label="six_wheel")
        finally:
            sockets.serve = opened
    if not guarded or port not in (None, 0, server.get_port()):
        stop_server(server)
        if not guarded:
            raise RuntimeError(
                f"viser {viser.__version__} opens its socket unguarded: {INSTALL} takes another"
            )
        raise ValueError(f"port {port} is taken; --port 0 takes a free one")
    return server


@contextlib.asynccontextmanager
async def _nobody() -> AsyncIterator[Any]:
    """A server without sockets."""
    yield SimpleNamespace(server=SimpleNamespace(sockets=()))


def _guard(process: Callable[[Any, Any], Any] | None, page: bytes) -> Callable[[Any, Any], Any]:
    """The handler of requests behind a check of their headers, with a page of its own."""

    def check(connection: Any, request: Any) -> Any:
        headers = request.headers
        if not is_local(headers.get_all("Host"), headers.get_all("Origin")):
            return connection.respond(http.HTTPStatus.FORBIDDEN, "only pages of this server may ask\n")
        if urlsplit(request.path).path == "/" and "Upgrade" not in headers:
            response = connection.respond(http.HTTPStatus.OK, "")
            response.body = page
            del response.headers["Content-Length"], response.headers["Content-Type"]
            response.headers["Content-Length"] = str(len(page))
            response.headers["Content-Type"] = "text/html; charset=utf-8"
            return response
        return None if process is None else process(connection, request)

    return check


def stop_server(server: viser.ViserServer) -> None:
    """Stop a server; what has not ended after `STOP_TIME` is left to a thread that ends with the process."""

    def stop() -> None:
        with _silent():
            server.stop()

    thread = threading.Thread(target=stop, name="six_wheel view stops", daemon=True)
    thread.start()
    thread.join(STOP_TIME)


@contextlib.contextmanager
def _silent() -> Iterator[None]:
    """Without what viser prints by rich on the standard output."""
    import rich

    console = rich.get_console()
    before, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = before
