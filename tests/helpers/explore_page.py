"""The page in the tests' browser: how it is opened, moved and read."""

PAINTED = "new Promise(done => requestAnimationFrame(() => setTimeout(done, 60)))"


def ready(page):
    """Wait until the page can be used and has drawn its state."""
    page.wait_for_selector("html[data-ready]", state="attached")
    rest(page)


def rest(page):
    """Wait until the page has drawn its state in full."""
    page.wait_for_timeout(350)
    page.evaluate(PAINTED)


def slide(page, name, value):
    slider = page.locator(f"#p-{name}")
    slider.evaluate(
        "(slider, value) => { slider.value = value; slider.dispatchEvent(new Event('input')); }",
        value,
    )


def typed(page, name, text):
    page.fill(f"#n-{name}", text)
    page.press(f"#n-{name}", "Enter")


def picture(page):
    return page.locator("#map").screenshot()


def table(page):
    """Return the numbers of the table of margins by name."""
    rows = page.locator("#margins tr").all_inner_texts()
    pairs = (row.replace("−", "-").split("\t") for row in rows)
    return {name.strip(): float(value.split()[0]) for name, value in pairs if value.strip()}


# At once: a page that is still drawing disables its buttons anew in every frame.
FORCED = "() => { const it = document.getElementById('numbers'); it.disabled = false; it.click(); }"


def taken(page, *, forced=False):
    """Return the lines of the numbers that are taken home; ``forced``: even if they may not be."""
    with page.expect_download() as numbers:
        if forced:
            page.evaluate(FORCED)
        else:
            page.click("#numbers")
    return numbers.value.path().read_text(encoding="utf-8").splitlines()
