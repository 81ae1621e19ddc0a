"""Pages are served to this machine alone, and nothing of the server outlives its time."""

import http.client
import os
import signal
import socket
import subprocess
import sys
import threading
from pathlib import Path
from urllib.parse import urlsplit

import pytest

import ffsr_plan as fp
from ffsr_plan.display.plan_page import page
from ffsr_plan.display.web.page_server import PageServer

ENVIRONMENT = {**os.environ, "BROWSER": "true"}  # of subprocesses: nothing opens


def port_of(url):
    return urlsplit(url).port


def get(url, method="GET", path="/", hosts=None):
    """Status and text; `hosts` are the Host headers, by default the right one."""
    line = http.client.HTTPConnection("127.0.0.1", port_of(url), timeout=20)
    line.putrequest(method, path, skip_host=hosts is not None)
    for host in hosts or ():
        line.putheader("Host", host)
    line.endheaders()
    answer = line.getresponse()
    return answer.status, answer.read().decode()


def listens(port, address="127.0.0.1"):
    with socket.socket() as line:
        line.settimeout(20)
        return line.connect_ex((address, port)) == 0


def listening_sockets(port):
    """Local addresses in hexadecimal, as the kernel lists them."""
    rows = [
        row.split()
        for table in ("tcp", "tcp6")
        for row in Path(f"/proc/net/{table}").read_text().splitlines()[1:]
    ]
    addresses = [row[1].split(":") for row in rows if row[3] == "0A"]
    return [address for address, number in addresses if int(number, 16) == port]


def own_addresses():
    """Of this machine; of the loopback network too, all of which answers on every machine."""
    found = {"127.0.0.2"}
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as line:
        try:
            line.connect(("192.0.2.1", 9))  # reserved for documentation; nothing is sent
            found.add(line.getsockname()[0])
        except OSError:
            pass
    return found - {"127.0.0.1"}


def children():
    """Processes that this one has started and not yet seen the end of."""
    tasks = Path("/proc/self/task").iterdir()
    return {child for t in tasks for child in (t / "children").read_text().split()}


def in_session(leader):
    """Processes of the session that a process leads."""
    found = []
    for entry in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = entry.read_text().rpartition(")")[2].split()
        except OSError:  # it has ended meanwhile
            continue
        if int(fields[3]) == leader and fields[0] != "Z":
            found.append(entry.parent.name)
    return found


def started(*command):
    """A process that leads a session of its own, and the address that it prints first."""
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    process = subprocess.Popen(
        [sys.executable, *command], start_new_session=True, env=ENVIRONMENT, **pipes
    )
    return process, process.stdout.readline().split()[0]


@pytest.fixture(scope="module")
def plan_file(fig2a_plan, tmp_path_factory):
    path = tmp_path_factory.mktemp("shown") / "plan.json"
    fig2a_plan.save(path)
    return path


@pytest.fixture
def server():
    with PageServer("<p>a page</p>") as server:
        yield server


def test_the_server_shows_the_page_of_the_plan(fig2a_plan):
    with fig2a_plan.show(block=False, open_browser=False, title="the title") as shown:
        assert get(shown.url) == (200, page(fig2a_plan, "the title"))


def test_it_listens_on_the_loopback_address_alone(server):
    port = port_of(server.url)
    assert listening_sockets(port) == ["0100007F"]
    assert listens(port)
    for address in own_addresses():
        assert not listens(port, address)


def test_a_server_on_all_addresses_would_be_noticed():
    """What the test above relies on."""
    with socket.create_server(("0.0.0.0", 0)) as line:
        port = line.getsockname()[1]
        assert listening_sockets(port) == ["00000000"]
        assert all(listens(port, address) for address in own_addresses())


@pytest.mark.parametrize(
    "hosts",
    [
        ["evil.example"],
        ["evil.example:80"],
        [],
        ["127.0.0.1.evil.example"],
        ["[::1"],
        [""],
        ["127.0.0.1", "evil.example"],
        ["127.0.0.1@evil.example"],
        ["evil-localhost"],
    ],
    ids=str,
)
def test_requests_for_other_host_names_are_refused(server, hosts):
    for path in ("/", "/events"):
        status, text = get(server.url, path=path, hosts=hosts)
        assert status == 403
        assert "a page" not in text


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost", "LOCALHOST:9000", "127.0.0.1:1"])
def test_requests_may_name_this_machine_and_any_port(server, host):
    assert get(server.url, hosts=[host]) == (200, "<p>a page</p>")


@pytest.mark.parametrize("path", ["/etc/passwd", "/../page.py", "/web/", "/page.html"])
def test_other_addresses_are_not_found(server, path):
    assert get(server.url, path=path)[0] == 404


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "OPTIONS", "HEAD"])
def test_only_get_requests_are_answered(server, method):
    status, text = get(server.url, method)
    assert status == 501
    assert "a page" not in text


def test_stopping_ends_all_threads_and_frees_the_port():
    before, own = set(threading.enumerate()), children()
    server = PageServer("")
    port = port_of(server.url)
    with socket.create_connection(("127.0.0.1", port), timeout=10) as idle:
        listener = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
        listener.request("GET", "/events")
        answer = listener.getresponse()
        assert server.wait_for_listener(20)
        assert children() == own
        server.stop()
        assert answer.read() == b""
        assert idle.recv(1) == b""
    assert set(threading.enumerate()) == before
    assert not listens(port)
    with PageServer("", port):
        pass
    server.stop()  # once more does nothing


def test_the_last_message_is_sent_before_the_end(server):
    """Even if a listener is still busy with an earlier message when the server is stopped."""
    gate = threading.Event()
    server.publish(lambda: "early" if gate.wait(60) else "never")
    listener = http.client.HTTPConnection("127.0.0.1", port_of(server.url), timeout=60)
    listener.request("GET", "/events")
    answer = listener.getresponse()
    assert server.wait_for_listener(20)
    stopping = threading.Thread(target=server.stop)
    server.publish(lambda: "last")
    stopping.start()
    gate.set()
    assert answer.read().decode().split("data: ")[-1] == "last\n\n"
    stopping.join()


def test_two_pages_can_be_shown_at_once():
    with PageServer("one") as one, PageServer("two") as two:
        assert (get(one.url)[1], get(two.url)[1]) == ("one", "two")


@pytest.mark.parametrize("port", [-1, 65536, 8000.0, True, "8000"])
def test_ports_are_checked(port):
    with pytest.raises(fp.InvalidInput, match="port"):
        PageServer("", port)


def test_a_port_in_use_is_refused_by_its_number(server):
    port = port_of(server.url)
    with pytest.raises(fp.InvalidInput, match=rf"port.*{port}.*free"):
        PageServer("", port)


@pytest.mark.parametrize("wrong", [{"block": 1}, {"open_browser": "yes"}])
def test_switches_that_are_not_booleans_are_refused(fig2a_plan, wrong):
    with pytest.raises(fp.InvalidInput, match=next(iter(wrong))):
        fig2a_plan.show(**{"block": False, "open_browser": False, **wrong})


def test_the_browser_is_opened_at_the_page(fig2a_plan, monkeypatch):
    opened = []
    monkeypatch.setattr("ffsr_plan.display.web.browser.open_in_browser", opened.append)
    with fig2a_plan.show(block=False) as shown:
        assert opened == [shown.url]
    with fig2a_plan.show(block=False, open_browser=False):
        assert len(opened) == 1


def test_a_killed_process_leaves_nothing_behind(plan_file):
    script = (
        f"import ffsr_plan as fp; shown = fp.Plan.load({str(plan_file)!r})"
        ".show(block=False, open_browser=False); print(shown.url, flush=True); shown.wait()"
    )
    process, url = started("-c", script)
    with process:
        assert get(url)[0] == 200
        assert in_session(process.pid) == [str(process.pid)]
        process.kill()
        process.communicate(timeout=60)
    assert in_session(process.pid) == []
    assert not listens(port_of(url))


def test_a_script_ends_although_its_page_is_shown(plan_file):
    script = (
        f"import ffsr_plan as fp; shown = fp.Plan.load({str(plan_file)!r})"
        ".show(block=False, open_browser=False); print(shown.url, flush=True)"
    )
    process, url = started("-c", script)
    with process:
        try:
            assert process.wait(timeout=20) == 0
        finally:
            process.kill()
    assert not listens(port_of(url))


def test_view_serves_until_ctrl_c_and_that_is_no_error(plan_file, fig2a_plan):
    run = "from ffsr_plan.cli import main; main()"
    process, url = started("-c", run, "view", str(plan_file), "--no-browser")
    with process:
        assert get(url) == (200, page(fig2a_plan))
        assert in_session(process.pid) == [str(process.pid)]
        process.send_signal(signal.SIGINT)
        _, complaints = process.communicate(timeout=60)
        assert (process.returncode, complaints) == (0, "")
    assert in_session(process.pid) == []
    assert not listens(port_of(url))


def test_view_refuses_files_and_ports_that_are_unusable(plan_file, server, tmp_path):
    from typer.testing import CliRunner

    from ffsr_plan.cli import app

    (tmp_path / "torn.json").write_text(plan_file.read_text()[:5000])
    for arguments in (
        ["missing.json"],
        [str(tmp_path / "torn.json")],
        [str(plan_file), "--port", "70000"],
        [str(plan_file), "--port", str(port_of(server.url))],
    ):
        result = CliRunner().invoke(app, ["view", *arguments, "--no-browser"])
        assert result.exit_code == 2
        assert result.stderr.startswith("ffsr-plan: ")
        assert "Traceback" not in result.output


@pytest.mark.slow
def test_a_notebook_shows_a_frame_and_its_kernel_ends(plan_file):
    nbformat = pytest.importorskip("nbformat")
    client = pytest.importorskip("nbclient").NotebookClient
    cells = [
        f"import ffsr_plan as fp\nfp.Plan.load({str(plan_file)!r}).show()",
        "import os\nprint(os.getpid())",
    ]
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(c) for c in cells])
    runner = client(notebook, timeout=120)
    with runner.setup_kernel():
        for k, cell in enumerate(notebook.cells):
            runner.execute_cell(cell, k)
        frame = notebook.cells[0].outputs[-1]["data"]["text/html"]
        url = frame.split('src="')[1].split('"')[0]
        assert frame.startswith("<iframe")
        assert get(url)[0] == 200
        kernel = int(notebook.cells[1].outputs[0]["text"])
    assert not Path(f"/proc/{kernel}").exists()
    assert not listens(port_of(url))
