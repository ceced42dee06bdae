"""Pictures to turn around as parts of a page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from markupsafe import Markup

from tisim.view import View
from tisim.view.page import script, section, style


@dataclass(frozen=True, kw_only=True)
class Turned:
    """HTML of each picture; CSS and script of the page, once, empty where there is none."""

    sections: Mapping[View, Markup]
    style: Markup
    script: Markup


def turned_parts(views: Sequence[View]) -> Turned:
    """The views as parts of one page."""
    if not views:
        return Turned(sections={}, style=Markup(), script=Markup())
    return Turned(
        sections={view: Markup(section(view)) for view in views},
        style=Markup(style()),
        script=Markup(f"<script>{script()}</script>"),
    )
