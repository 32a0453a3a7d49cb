"""The committed picture of the rooms shows the rooms, their files and the imports of today."""

import re

from architecture import FLOORS, HOUSE, entries, imports, room

PICTURE = HOUSE.parent / "docs" / "rooms.svg"


def drawn(kind):
    """Texts of the picture by the name of the thing that they label."""
    found = re.findall(rf'<g id="({kind})">\s*<!-- (.*?) -->', PICTURE.read_text(encoding="utf-8"))
    assert found, f"{PICTURE.name} has no {kind}"
    return dict(found)


def test_it_shows_what_is_in_every_room():
    expected = {
        f"in {name}": sorted(entry.removesuffix(".py") for entry in entries(HOUSE / name))
        for names in FLOORS
        for name in names
    }
    shown = {key: sorted(re.split(r"/? +|/$", text)) for key, text in drawn(r"in \w+").items()}
    assert shown == expected, "draw it anew: python docs/draw_rooms.py"


def test_it_counts_the_imports_between_rooms():
    pairs = {(one.importer, one.imported) for one in imports(HOUSE)}
    rooms = [(room(importer), room(imported)) for importer, imported in pairs]
    expected = {
        f"{one} imports {other}": str(rooms.count((one, other)))
        for one, other in rooms
        if one != other
    }
    assert drawn(r"\w+ imports \w+") == expected, "draw it anew: python docs/draw_rooms.py"
