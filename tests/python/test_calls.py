"""Long calls: the interpreter goes on meanwhile, Ctrl-C ends them, callbacks and exceptions come through."""

import logging
import os
import signal
import subprocess
import sys
import threading
import time

import pytest

import ricci
from conftest import assert_same_results


@pytest.fixture(scope="module")
def large():
    return ricci.generate("eight", faces=6000)


def in_thread(work):
    """Runs work() in another thread; whether it has ended can be asked."""
    outcome = []
    thread = threading.Thread(target=lambda: outcome.append(work()))
    thread.start()
    return thread, outcome


def test_other_threads_run_meanwhile(large):
    counted = 0
    thread, outcome = in_thread(lambda: ricci.sweep(large, vertices="sample:200", threads=1))
    while thread.is_alive():
        counted += 1  # needs the interpreter's lock
        time.sleep(0.001)
    thread.join()
    assert len(outcome[0].vertex) == 200
    assert counted > 20


def test_two_calls_at_a_time_give_the_same_bits(large):
    alone = ricci.sweep(large, vertices="sample:40", threads=2)
    thread, outcome = in_thread(lambda: ricci.sweep(large, vertices="sample:40", threads=2))
    other = ricci.sweep(large, vertices="sample:40", threads=2)
    thread.join()
    assert alone.area_distortion.tobytes() == other.area_distortion.tobytes()
    assert alone.area_distortion.tobytes() == outcome[0].area_distortion.tobytes()


def test_progress_of_a_sweep(large):
    seen, threads = [], set()

    def progress(p):
        seen.append(p)
        threads.add(threading.current_thread())

    ricci.sweep(large, vertices="sample:150", threads=1, progress=progress)
    assert threads == {threading.current_thread()}
    assert seen[-1].solves_done == seen[-1].solves_known == 150 and seen[-1].sources == 1
    assert [p.solves_done for p in seen] == sorted(p.solves_done for p in seen)
    assert len(seen) > 2


def test_progress_of_a_flow(large):
    seen = []
    result = ricci.flow(large, cones={0: "-4pi"}, progress=seen.append)
    assert abs(seen[-1].residual_max - result.residual_max) < 1e-11 and seen[-1].iteration == result.newton_iterations


def test_exception_of_a_callback_ends_the_call_and_can_be_resumed(large):
    whole = ricci.sweep(large, vertices="sample:300", output="whole.h5")
    assert whole.status == "converged"

    class Enough(Exception):
        pass

    def progress(p):
        if p.solves_done >= 60:
            raise Enough(f"{p.solves_done}")

    with pytest.raises(Enough):
        ricci.sweep(large, vertices="sample:300", output="x.h5", progress=progress, threads=1)
    assert os.path.isdir("x.h5.parts") and not os.path.exists("x.h5")
    left = []
    ricci.sweep(large, vertices="sample:300", output="x.h5", resume=True,
                progress=lambda p: left.append(p.solves_known))  # fmt: skip
    assert 0 < left[-1] < 300
    assert_same_results("whole.h5", "x.h5")


INTERRUPTED = """
import sys, ricci
mesh = ricci.generate("eight", faces=20000)
print("begin", flush=True)
try:
    {call}
    print("not stopped")
except KeyboardInterrupt:
    print("stopped", flush=True)
"""


@pytest.mark.parametrize("call", [
    'ricci.sweep(mesh, output="c.h5")',
    "ricci.sweep(mesh, threads=1)",
    "ricci.flow(mesh, scheme='tangential', geometry='hyperbolic', method='gradient', tolerance=1e-14)",
    "ricci.spectrum(mesh, max_length=12.0, words=False)",
    'ricci.generate("torus", faces=400).save("t.off"); mesh.save("m.off"); '
    'ricci.Index.build("i.h5", ["m.off"], max_length=12.0, fingerprint=1000)',
])  # fmt: skip
def test_ctrl_c(call):
    child = subprocess.Popen([sys.executable, "-c", INTERRUPTED.format(call=call)], stdout=subprocess.PIPE,
                             stderr=subprocess.PIPE, text=True)  # fmt: skip
    assert child.stdout.readline() == "begin\n"
    time.sleep(1.0)
    child.send_signal(signal.SIGINT)
    begin = time.monotonic()
    out, err = child.communicate()
    assert out == "stopped\n", err
    assert child.returncode == 0
    print(f"{call}: ended after {time.monotonic() - begin:.2f} s")


STOPPED = """
import ricci
begun = []
def progress(p):
    if p.solves_done >= 30 and not begun:
        begun.append(print("begun", flush=True))
try:
    ricci.sweep("m.off", vertices="sample:400", output="c.h5", resume=True, threads=1, progress=progress)
    print("done")
except KeyboardInterrupt:
    print("stopped")
"""


def test_sweep_stopped_by_ctrl_c_is_resumed(run_ricci):
    """By Python and by the command line, to the same bits."""
    mesh = ricci.generate("eight", faces=4000)
    mesh.save("m.off")
    ricci.sweep("m.off", vertices="sample:400", output="whole.h5")
    for again in (False, True):
        child = subprocess.Popen([sys.executable, "-c", STOPPED], stdout=subprocess.PIPE, text=True)
        begun = child.stdout.readline()
        child.send_signal(signal.SIGINT)
        end = child.communicate()[0]
        assert child.returncode == 0
        assert begun == "begun\n" and end == "stopped\n" or again  # there may not be much left by then
        assert again or not os.path.exists("c.h5")
    run_ricci("sweep", "m.off", "--vertices", "sample:400", "-o", "c.h5", "--resume", "-q")
    assert_same_results("whole.h5", "c.h5")


def test_handlers_of_signals_stay(large):
    """METIS, which orders unknowns, would leave a handler that works once, or catch the signal itself."""
    caught = []
    before = signal.signal(signal.SIGTERM, lambda *_: caught.append(1))
    try:
        done = threading.Event()

        def pester():
            while not done.is_set():
                os.kill(os.getpid(), signal.SIGTERM)
                time.sleep(0.01)

        thread = threading.Thread(target=pester)
        thread.start()
        result = ricci.sweep(large, vertices="sample:20")
        done.set()
        thread.join()
        assert set(result.statuses) == {"converged"}
        assert len(caught) > 1
        os.kill(os.getpid(), signal.SIGTERM)
        count = len(caught)
        os.kill(os.getpid(), signal.SIGTERM)
        assert len(caught) > count
    finally:
        signal.signal(signal.SIGTERM, before)


def test_log_goes_to_logging(caplog):
    torus = ricci.generate("torus", faces=300)
    with caplog.at_level(logging.DEBUG, logger="ricci"):
        ricci.sweep([torus])
    assert any(r.levelno == logging.ERROR and "inadmissible_target" in r.getMessage() for r in caplog.records)
    assert {r.name for r in caplog.records} == {"ricci"}


def test_nothing_is_printed():
    code = 'import ricci\nricci.sweep(ricci.generate("eight", faces=600), vertices="sample:5")\n'
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_numpy_keeps_its_threads(large):
    """OpenBLAS runs one thread during a call, and as many as before it afterwards."""
    code = """
import ctypes, numpy, ricci
paths = {l.split()[-1] for l in open("/proc/self/maps") if "libopenblas" in l}
blas = ctypes.CDLL(*paths)
blas.openblas_set_num_threads(3)
ricci.sweep(ricci.generate("eight", faces=600), vertices="sample:5")
print(blas.openblas_get_num_threads())
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "3\n"


def test_order_of_imports_does_not_matter(run_ricci):
    """The libraries that NumPy and h5py bring do not change the bits, whoever comes first."""
    mesh = ricci.generate("eight", faces=3000)
    mesh.save("m.off")
    run_ricci("sweep", "m.off", "--vertices", "sample:24", "-o", "program.h5", "-q")
    for k, modules in enumerate(("numpy, numpy.linalg, h5py, ricci", "ricci, h5py, numpy.linalg")):
        code = f"import {modules}\nricci.sweep('m.off', vertices='sample:24', output='o{k}.h5', threads=2)\n"
        subprocess.run([sys.executable, "-c", code], check=True)
        assert_same_results("program.h5", f"o{k}.h5")


def test_version(run_ricci):
    info = ricci.build_info()
    assert f"ricci {ricci.__version__} ({info['git']}), {info['solver']}" == run_ricci("--version").strip()
