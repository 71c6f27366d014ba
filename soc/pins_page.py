# SPDX-License-Identifier: BSD-2-Clause
"""The pins of a board as a page and a drawing, rendered from its constraint file; no dates, stable order."""

from html import escape

from soc.pins import package

__all__ = ["files", "render_drawing", "render_page"]

COLOURS = {"encoder": "#3b6fb6", "limit": "#d98324", "motor": "#b8322c", "stop": "#6d0f0f", "ttl": "#2f8f4e",
           "dac": "#7b4fa3", "panel": "#1f8a8a", "adc": "#8a6a3a", "serial": "#5c6670"}
"""Of the groups that come to a header."""
OTHER_COLOUR, SUPPLY_COLOUR, GROUND_COLOUR = "#999999", "#ffffff", "#222222"

PITCH = 26
COLUMN = 90, 690
"""Left edges of the drawings of two headers, with room for names on both sides; further ones go below them."""
SIDE, NAME_WIDTH, TITLE_HEIGHT = 22, 190, 60


def arrow(direction, left):
    """Toward the pin: into the FPGA.  ``left``: the name stands left of its pin."""
    return {"in": "→" if left else "←", "out": "←" if left else "→", "inout": "↔"}[direction]


def render_page(constraints, board_file):
    """The page: the drawing, each header row by row, then every pin by group."""
    names = ", ".join(f"`{board.name}`" for board in board_file.boards)
    reference = board_file.boards[0]
    balls = package(reference.device, reference.package)
    facts = board_file.facts
    numbers = {}
    lines = [f"# Pins of {board_file.name}", "",
             f"Generated from `constraints/{board_file.name}.lpf` by `python -m soc.pins`; `make lint` fails if stale. "
             f"For {names}. Directions are as the FPGA sees them; *italic* is allotted for later.", ""]
    if facts and facts.headers:
        at = {pin.place: pin for pin in constraints.pins}
        lines += [f"![The headers]({board_file.name}-pins.svg)", ""]
        for header, rows in facts.headers.items():
            lines += [f"## {header}, {facts.view}", "",
                      "| signal | place | pin | pin | place | signal |", "|---:|---:|---:|:---|:---|:---|"]
            for (left, left_place), (right, right_place) in rows:
                named = (left_place, f"{header}-{left}"), (right_place, f"{header}-{right}")
                numbers |= {place: name for place, name in named if place in facts.places and place != name}
                lines.append(f"| {signal(at.get(left_place))} | {left_place} | {left} | {right} | {right_place} | "
                             f"{signal(at.get(right_place))} |")
            lines.append("")
    for group, title in constraints.groups.items():
        columns = ["port", "place", *["header pin"] * bool(numbers), "ball", "bank", "direction", "undriven", "what"]
        lines += [f"## {title}", "", f"| {' | '.join(columns)} |", "|" + "---|" * len(columns)]
        for pin in (p for p in constraints.pins if p.group == group):
            name = f"*{pin.name}*" if pin.reserved else f"`{pin.name}`"
            number = f"{numbers.get(pin.place, '')} | " if numbers else ""
            lines.append(f"| {name} | {pin.place} | {number}{pin.ball} | {balls[pin.ball].bank} | "
                         f"{pin.direction} | {pin.settings['PULLMODE'].lower()} | {pin.what} |")
        lines.append("")
    return "\n".join(lines[:-1]) + "\n"


def signal(pin):
    return "" if not pin else f"*{pin.name}*" if pin.reserved else pin.name


def render_drawing(constraints, facts):
    """The headers as SVG, each pin in the colour of its group."""
    at = {pin.place: pin for pin in constraints.pins}
    drawn = {at[place].group for rows in facts.headers.values() for row in rows for _number, place in row if place in at}
    used = [group for group in constraints.groups if group in drawn]
    block = TITLE_HEIGHT + max(map(len, facts.headers.values())) * PITCH
    legend = block * -(-len(facts.headers) // len(COLUMN)) + 30
    width, height = 1080, legend + 30 * -(-len(used) // 3) + 40
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
           'font-family="sans-serif" font-size="13">',
           f'<rect width="{width}" height="{height}" fill="#ffffff"/>']
    for n, (header, header_rows) in enumerate(facts.headers.items()):
        x0, top = COLUMN[n % len(COLUMN)] + NAME_WIDTH - COLUMN[0], TITLE_HEIGHT + n // len(COLUMN) * block
        out.append(text(x0 + SIDE + 2, top - 26, header, anchor="middle", weight="bold", size=16))
        for row, pins in enumerate(header_rows):
            y = top + row * PITCH
            for left, (number, place) in zip((True, False), pins):
                x = x0 + (0 if left else SIDE + 4)
                label = place if place != f"{header}-{number}" else ""
                out += pin_drawing(x, y, number, label, at.get(place), left)
    view = facts.view[0].upper() + facts.view[1:]
    out.append(text(width / 2 - 40, TITLE_HEIGHT - 40, view, anchor="middle", size=12))
    for i, group in enumerate(used):
        x, y = 60 + 340 * (i % 3), legend + 30 * (i // 3)
        out.append(f'<rect x="{x}" y="{y - 12}" width="16" height="16" fill="{COLOURS.get(group, OTHER_COLOUR)}"/>')
        title = constraints.groups[group].partition(":")[0]
        out.append(text(x + 24, y + 1, title, size=13))
    out.append(text(60, height - 16, "Arrow toward the pin: into the FPGA.  Pale and italic: allotted for later.", size=12))
    return "\n".join([*out, "</svg>"]) + "\n"


def pin_drawing(x, y, number, label, pin, left):
    """One square with its number, its label outside, and its signal farther outside."""
    dark = label == "GND"
    fill, opacity = GROUND_COLOUR if dark else SUPPLY_COLOUR, 1
    if pin:
        fill, opacity = COLOURS.get(pin.group, OTHER_COLOUR), 0.35 if pin.reserved else 1
        dark = not pin.reserved
    out = [f'<rect x="{x}" y="{y}" width="{SIDE}" height="{SIDE}" fill="{fill}" fill-opacity="{opacity}" '
           'stroke="#222222"/>',
           text(x + SIDE / 2, y + SIDE / 2 + 4, str(number), anchor="middle", size=10,
                colour="#ffffff" if dark else "#222222")]
    edge, step, anchor = (x - 6, -1, "end") if left else (x + SIDE + 6, 1, "start")
    if label:
        out.append(text(edge, y + SIDE / 2 + 4, label, anchor=anchor, size=11, colour="#555555"))
    if pin:
        to_pin = arrow(pin.direction, left)
        name = f"{pin.name} {to_pin}" if left else f"{to_pin} {pin.name}"
        out.append(text(edge + step * 36 * bool(label), y + SIDE / 2 + 5, name, anchor=anchor,
                        style="italic" if pin.reserved else None))
    return out


def text(x, y, content, *, anchor="start", size=13, weight=None, style=None, colour="#111111"):
    extra = (f' font-weight="{weight}"' if weight else "") + (f' font-style="{style}"' if style else "")
    return f'<text x="{x:g}" y="{y:g}" text-anchor="{anchor}" font-size="{size}" fill="{colour}"{extra}>{escape(content)}</text>'


def files(constraints, board_file):
    """``{path below the root: text}`` of what is rendered for a board."""
    stem = f"docs/boards/{board_file.name}-pins"
    result = {f"{stem}.md": render_page(constraints, board_file)}
    if board_file.facts and board_file.facts.headers:
        result[f"{stem}.svg"] = render_drawing(constraints, board_file.facts)
    return result
