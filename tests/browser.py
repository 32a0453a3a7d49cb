"""Pages in a browser without a window."""

import html
import re
import shutil
import subprocess
from pathlib import Path

NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")

LOOK = """
<script>
addEventListener("load", () => {
  const images = [...document.images];
  document.body.dataset.seen = JSON.stringify({
    images: images.length,
    broken: images.filter(image => image.naturalWidth === 0).length,
    fetched: performance.getEntriesByType("resource").filter(one => !one.name.startsWith("data:")).length,
    too_wide: document.documentElement.scrollWidth - document.documentElement.clientWidth,
    ground: getComputedStyle(document.body).backgroundColor,
    text: getComputedStyle(document.body).color,
  });
});
</script>
"""


def find_browser():
    """Path of Chromium or Chrome; None where there is none."""
    return next((path for name in NAMES if (path := shutil.which(name))), None)


def looked_at(browser: str, page: Path, *options: str, folder: Path) -> str:
    """What a browser sees of a page, as JSON: images, broken ones, what it fetched, colours."""
    copy = folder / "looked_at.html"
    text = page.read_text(encoding="utf-8")
    copy.write_text(text.replace("</body>", f"{LOOK}</body>"), encoding="utf-8")
    command = [
        browser, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={folder / 'profile'}",
        "--virtual-time-budget=5000", *options, "--dump-dom", copy.as_uri(),
    ]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=True)
    found = re.search(r'data-seen="([^"]*)"', done.stdout)
    assert found, done.stdout[-2000:] + done.stderr[-2000:]
    return html.unescape(found[1])
