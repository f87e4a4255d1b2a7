"""The server talks to this machine only, takes the port it is given or none, and ends when it is told."""

import http.client
import importlib.metadata
import os
import pickle
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import six_wheel as sw
from six_wheel.view.server import is_local
from tests.cli_runs import Run

Open = Callable[..., Any]
EVIL = "http://evil.example"


def status(port: int, **headers: str) -> int:
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=10)
    connection.putrequest("GET", "/", skip_host="Host" in headers)
    for name, value in headers.items():
        connection.putheader(name, value)
    connection.endheaders()
    found = connection.getresponse().status
    connection.close()
    return found


def viser_version() -> str:
    return importlib.metadata.version("viser")


@pytest.mark.parametrize(
    ("hosts", "origins", "local"),
    [
        (["127.0.0.1:80"], [], True),
        (["localhost:80"], ["http://localhost:80"], True),
        (["[::1]:80"], ["http://[::1]:80"], True),
        (["127.0.0.1:80"], ["http://localhost:80"], True),
        (["127.0.0.1:80"], [EVIL], False),
        (["127.0.0.1:80"], ["null"], False),
        (["127.0.0.1:80"], ["http://127.0.0.1:81"], False),  # another server of this machine
        (["evil.example:80"], [], False),
        (["127.0.0.1.evil.example:80"], [], False),
        (["evil.example@127.0.0.1.evil.example"], [], False),
        (["127.0.0.1:port"], [], False),
        (["127.0.0.1:80", "evil.example"], [], False),
        (["127.0.0.1:80"], ["http://127.0.0.1:80", EVIL], False),
        ([], [], False),
    ],
)
def test_only_pages_of_this_server_are_local(hosts: list[str], origins: list[str], local: bool) -> None:
    assert is_local(hosts, origins) == local


def test_a_foreign_host_or_origin_is_refused(opened: Open) -> None:
    port = int(opened("husky").url.rpartition(":")[2])
    assert status(port) == 200
    assert status(port, Origin=f"http://127.0.0.1:{port}") == 200
    assert status(port, Origin=EVIL) == 403
    assert status(port, Host=f"evil.example:{port}") == 403


def test_a_web_socket_of_a_foreign_page_is_refused(opened: Open) -> None:
    from websockets.exceptions import InvalidStatus
    from websockets.sync.client import connect

    url = opened("husky").url.replace("http", "ws")
    with pytest.raises(InvalidStatus) as refused:
        connect(url, origin=EVIL)  # type: ignore[arg-type]
    assert refused.value.response.status_code == 403
    own, viser = url.replace("ws", "http"), f"viser-v{viser_version()}"
    with connect(url, origin=own, subprotocols=[viser]) as allowed:  # type: ignore[arg-type, list-item]
        assert allowed.recv(timeout=10)


def test_it_listens_on_the_loopback_alone(opened: Open) -> None:
    port = int(opened("husky").url.rpartition(":")[2])
    with open("/proc/net/tcp") as table:
        places = [line.split()[1] for line in table.readlines()[1:] if line.split()[3] == "0A"]
    assert [place for place in places if place.endswith(f":{port:04X}")] == [f"0100007F:{port:04X}"]


def test_nobody_can_have_it_shared(opened: Open) -> None:
    view = opened("husky")
    assert view._server.request_share_url() is None
    assert view._server._share_tunnel is None


def test_a_port_that_is_taken_or_none_is_refused() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(ValueError, match=f"port {port} is taken; --port 0 takes a free one"):
            sw.view("husky", port=port, open=False)
    for port in (-1, 65536, True, 8080.0):
        with pytest.raises(ValueError, match="port must be from 0 to 65535, got") as told:
            sw.view("husky", port=port, open=False)  # type: ignore[arg-type]
        assert isinstance(told.value, TypeError) == (type(port) is not int)


def test_a_page_is_written_without_a_port(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """It was saved from a server that anybody on this machine could have asked meanwhile."""
    bound: list[Any] = []
    bind = socket.socket.bind

    def noted(one: socket.socket, place: Any) -> None:
        bound.append(place)
        bind(one, place)

    monkeypatch.setattr(socket.socket, "bind", noted)
    assert run("view", "husky", "--export", "page.html")[0] == 0
    assert Path("page.html").stat().st_size > 500_000
    assert not bound


def test_two_views_at_once_and_closing_twice(opened: Open) -> None:
    first, second = opened("husky"), opened("curio_sawppy")
    assert first.url != second.url
    first.close()
    first.close()
    assert "closed" in repr(first)
    assert status(int(second.url.rpartition(":")[2])) == 200
    with pytest.raises(TypeError, match="cannot be pickled"):
        pickle.dumps(second)
    assert second.url in second._repr_html_()


def test_nothing_is_left_of_a_view(opened: Open) -> None:
    view = opened("husky")
    view.close()
    for _ in range(100):
        if not [thread for thread in threading.enumerate() if thread.name.startswith("six_wheel view")]:
            break
        time.sleep(0.05)
    assert not [thread.name for thread in threading.enumerate() if thread.name.startswith("six_wheel view")]
    with pytest.raises(OSError, match="refused"):
        status(int(view.url.rpartition(":")[2]))


@pytest.mark.parametrize("first", [signal.default_int_handler, signal.SIG_IGN])
def test_the_command_prints_its_address_alone_and_ends_by_ctrl_c(first: Any) -> None:
    """Also where a shell ignores Ctrl-C for programs in the background, and nobody but the test sends it."""
    command = [sys.executable, "-X", "faulthandler", "-m", "six_wheel", "view", "husky", "--no-browser"]
    process = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, first),
    )
    try:
        assert process.stdout is not None
        line = process.stdout.readline()
        assert line.startswith("http://127.0.0.1:")
        assert line.endswith("  (Ctrl-C ends)\n")
        os.kill(process.pid, signal.SIGINT)
        try:
            out, err = process.communicate(timeout=60)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGABRT)  # where its threads are goes to the error output
            out, err = process.communicate(timeout=60)
    finally:
        process.kill()
    assert (process.returncode, out, err) == (0, "", "")
