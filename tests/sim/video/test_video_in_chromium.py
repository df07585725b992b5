"""The video plays in a browser: headless Chromium loads it, knows its length and plays it."""

from __future__ import annotations

import functools
import http.server
import json
import queue
import shutil
import subprocess
import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from video_arenas import SQUARE, walled

from sim.video import Snapshot
from sim.video.recorder import Recorder
from tests.patience import PATIENCE

CHROMIUM = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
"""Wall-clock seconds for a browser to start and play; it takes three on an idle machine."""

PAGE = """<!doctype html><video id="v" src="run.mp4" muted autoplay playsinline></video>
<script>
const video = document.getElementById("v");
const tell = (what) => fetch("/result", {method: "POST", body: JSON.stringify(what)});
video.onerror = () => tell({error: video.error.message});
video.onended = () => {
  const canvas = document.createElement("canvas");
  canvas.width = video.videoWidth; canvas.height = video.videoHeight;
  const context = canvas.getContext("2d");
  context.drawImage(video, 0, 0);
  tell({width: video.videoWidth, height: video.videoHeight, duration: video.duration,
        played: video.currentTime, frames: video.getVideoPlaybackQuality().totalVideoFrames,
        robot: [...context.getImageData(ROBOT_X, ROBOT_Y, 1, 1).data].slice(0, 3)});
};
</script>"""


class Site(http.server.SimpleHTTPRequestHandler):
    """Serves the page and the video, and takes the page's report."""

    def __init__(self, *arguments: object, reports: queue.Queue[dict], directory: str) -> None:
        self.reports = reports
        super().__init__(*arguments, directory=directory)  # type: ignore[arg-type]

    def do_POST(self) -> None:
        length = int(self.headers["Content-Length"])
        self.reports.put(json.loads(self.rfile.read(length)))
        self.send_response(204)
        self.end_headers()

    def log_message(self, format: str, *arguments: object) -> None:
        pass


@pytest.fixture
def site(tmp_path: Path) -> Iterator[tuple[Path, str, queue.Queue[dict]]]:
    """A folder, the address under which it is served, and the reports that come in."""
    folder = tmp_path / "site"
    folder.mkdir()
    reports: queue.Queue[dict] = queue.Queue()
    handler = functools.partial(Site, reports=reports, directory=str(folder))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield folder, f"http://127.0.0.1:{server.server_port}/page.html", reports
        server.shutdown()
        thread.join()


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")
def test_the_video_plays_in_chromium(
    site: tuple[Path, str, queue.Queue[dict]], tmp_path: Path
) -> None:
    folder, address, reports = site
    pose = np.array([[8.0, 10.0, 0.0]])
    with Recorder(folder / "run.mp4", walled(16, 21)) as recorder:
        recorder.add_robot("r1", SQUARE)
        for tick in range(31):
            snapshot = Snapshot(
                tick * 0.4, pose, [0x00FF00], scans=[(0, pose[0], 3.0, np.full(180, 5.0))]
            )
            recorder.frame(snapshot)
    column, row = recorder.picture.projection.edges(np.array([7.7, 10.0])).astype(int)
    page = PAGE.replace("ROBOT_X", str(column)).replace("ROBOT_Y", str(row))
    (folder / "page.html").write_text(page)
    assert CHROMIUM is not None
    flags = "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --mute-audio"
    flags += " --disable-background-networking --disable-component-update --disable-sync"
    flags += " --disable-dev-shm-usage --autoplay-policy=no-user-gesture-required"
    browser = subprocess.Popen(
        [
            CHROMIUM,
            *flags.split(),
            f"--user-data-dir={tmp_path / 'profile'}",
            "--remote-debugging-port=0",
            address,
        ],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    try:
        report = reports.get(timeout=PATIENCE)
    finally:
        browser.terminate()
        browser.wait(PATIENCE)
    assert "error" not in report, report
    assert (report["width"], report["height"]) == (640, 840)
    assert report["duration"] == pytest.approx(31 / 25, abs=0.001)
    assert report["played"] == pytest.approx(31 / 25, abs=0.001)
    assert report["frames"] > 0
    red, green, blue = report["robot"]
    assert green > 150
    assert green > red + 100
    assert green > blue + 100
