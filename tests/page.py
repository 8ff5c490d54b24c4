"""What any report.html is held to: valid HTML5, nothing loaded, text for who cannot see, legible on both grounds."""

from __future__ import annotations

import re
from itertools import chain

import html5lib

PAPERS = {"light": "#ffffff", "dark": "#15181b"}  # of the template
READABLE = 4.5  # contrast of text, WCAG 2.2 AA
# Lines: Okabe and Ito's sky blue and orange reach 2.2 on white, and every party has a dash of its own besides.
VISIBLE = 2.0
HTML, SVG = "{http://www.w3.org/1999/xhtml}", "{http://www.w3.org/2000/svg}"


def parsed(page: str):
    """The page's tree and what a browser's parser would call errors, as (line, code)."""
    parser = html5lib.HTMLParser(html5lib.getTreeBuilder("etree"))
    tree = parser.parse(page)
    return tree, [(position[0], code) for position, code, _ in parser.errors]


def problems(page: str) -> list[str]:
    """Everything that is wrong with a page, in words; none where it is fit to be read."""
    tree, errors = parsed(page)
    found = [f"line {line}: {code}" for line, code in errors]
    elements = list(tree.iter())
    names = [element.get("id") for element in elements if element.get("id") is not None]
    found += [f"id {name} twice" for name in sorted({n for n in names if names.count(n) > 1})]
    for element in elements:
        for key in ("href", "src", "{http://www.w3.org/1999/xlink}href"):
            target = element.get(key)
            # a file of the same folder may be named
            beside = key == "href" and re.fullmatch(r"[\w-]+\.(rrd|toml|json)", target or "")
            if target is None or target.startswith("data:image/png;base64,") or beside:
                continue
            if target[1:] not in names:
                found.append(f"{target} is not inside the page")
        if element.tag == f"{HTML}img" and not element.get("alt"):
            found.append("an <img> without alt")
    drawn = tree.findall(f".//{HTML}figure/{SVG}svg")
    found += ["a figure without words" for s in drawn if s.get("role") != "img" or not s.get("aria-label")]
    if not tree.get("lang"):
        found.append("no language")
    if not "".join(t.text or "" for t in tree.iter(f"{HTML}title")).strip():
        found.append("no title")
    found += ["not one <h1>"] if len(list(tree.iter(f"{HTML}h1"))) != 1 else []
    return found + [line for s in drawn for line in illegible(s)] + illegible_style(page)


def luminance(colour: str) -> float:
    """Relative luminance of #rrggbb (WCAG 2.2)."""
    parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    """1 to 21 (WCAG 2.2)."""
    light, dark = sorted((luminance(one), luminance(other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def colours(style: str) -> dict[str, str]:
    """fill and stroke of an element's style, where they are opaque colours."""
    said = dict(part.split(":", 1) for part in style.replace(" ", "").split(";") if ":" in part)
    faint = [float(said.get(name, 1)) < 0.5 for name in ("opacity", "fill-opacity", "stroke-opacity")]
    if any(faint):
        return {}
    return {key: value for key, value in said.items() if key in ("fill", "stroke") and value.startswith("#")}


def illegible(svg) -> list[str]:
    """Text and lines of a figure that cannot be made out on the light or on the dark page.

    White on a map (an image, or a mesh of cells) lies on the map and not on the paper.
    """
    hatches = {path for pattern in svg.iter(f"{SVG}pattern") for path in pattern.iter()}  # they lie on their bar
    found, is_map = set(), any(e.tag == f"{SVG}image" or "QuadMesh" in (e.get("id") or "") for e in svg.iter())
    for element in svg.iter():
        is_text = element.tag == f"{SVG}text"
        is_line = element.tag in (f"{SVG}path", f"{SVG}use", f"{SVG}line")
        if not (is_text or is_line) or element in hatches:
            continue
        given = colours(element.get("style", ""))
        is_bare_marker = element.tag == f"{SVG}use" and "stroke:" not in element.get("style", "")
        for key, least in (("fill", READABLE), ("stroke", VISIBLE)):
            if key not in given or (is_map and given[key] == "#ffffff"):
                continue
            if is_line and key == "fill" and not is_bare_marker:
                continue
            least = VISIBLE if is_line else least
            for name, paper in PAPERS.items():
                ratio = contrast(given[key], paper)
                if ratio < least and len(given[key]) == 7:
                    words = "".join(element.itertext()).strip()[:20]
                    found.add(f"{element.tag.split('}')[1]} {words} {key} {given[key]} on {name}: {ratio:.2f}")
    return sorted(found)


def illegible_style(page: str) -> list[str]:
    """The page's own text colours against the grounds they stand on, in light, dark and print."""
    found = []
    schemes = re.findall(r":root \{([^}]*)\}", page)
    for scheme in schemes:
        colour = dict(re.findall(r"--(\w+): (#\w{6})", scheme))
        pairs = chain(
            ((ink, ground) for ink in ("ink", "accent") for ground in ("paper", "shade", "mark")),
            (("faint", "paper"), ("warn", "paper")),
        )
        found += [
            f"{ink} on {ground}: {contrast(colour[ink], colour[ground]):.2f}"
            for ink, ground in pairs
            if contrast(colour[ink], colour[ground]) < READABLE
        ]
    return found if len(schemes) == 3 else ["no light, dark and print scheme"]
