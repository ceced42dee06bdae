"""HTML frame of all pages (jinja2), with macros for tables and figures.

A module, so that an installed package has the templates without package data.
"""

from __future__ import annotations

from jinja2 import DictLoader, Environment, StrictUndefined, Template

FRAME = """\
<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{% block title %}{% endblock %}</title>
<style>
body { font: 15px/1.5 system-ui, sans-serif; color: #222; max-width: 76rem; margin: 2rem auto;
  padding: 0 1rem; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.3rem; border-bottom: 2px solid #0072B2; margin-top: 3rem; }
h3 { font-size: 1.05rem; margin: 1.8rem 0 .4rem; }
.trouble { background: #FDF1E6; border-left: 4px solid #D55E00; padding: .5rem 1rem; margin: .4rem 0; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: .86rem; font-variant-numeric: tabular-nums; }
th, td { padding: .3rem .6rem; text-align: left; border-bottom: 1px solid #DDE2E8; vertical-align: top; }
th { background: #F4F6F8; font-weight: 600; }
.chosen { font-weight: 700; } .bad { color: #B34700; font-weight: 600; }
.note { color: #5B6570; font-size: .88rem; max-width: 60rem; }
figure { margin: .8rem 0; } figure img { max-width: 100%; height: auto; }
figcaption { font-size: .85rem; color: #5B6570; max-width: 60rem; }
{% block style %}{% endblock %}
</style>
</head>
<body>
{% block body %}{% endblock %}
</body>
</html>
"""

PARTS = """\
{% macro cell(c) %}
<td{% if c.mark %} class="{{ c.mark }}"{% endif %}>
{%- if c.value is not none %}<data value="{{ c.value }}">{{ c.text }}</data>{% else %}{{ c.text }}{% endif -%}
</td>
{% endmacro %}
{% macro table(headings, rows) %}
<div class="wide"><table>
<thead><tr>{% for h in headings %}<th>{{ h }}</th>{% endfor %}</tr></thead>
<tbody>
{% for row in rows %}
<tr>
{% for c in row %}{{ cell(c) }}{% endfor %}
</tr>
{% endfor %}
</tbody>
</table></div>
{% endmacro %}
{% macro figure(p) %}
<figure><img src="{{ p.source }}" alt="{{ p.name }}"><figcaption>{{ p.caption }}</figcaption></figure>
{% endmacro %}
"""


def template(page: str) -> Template:
    """A page: it extends "frame" (blocks title, style and body), and has from "parts" the macros table and
    figure. Text is escaped, and a name that is not given is an error."""
    return Environment(
        loader=DictLoader({"frame": FRAME, "parts": PARTS, "page": page}),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    ).get_template("page")
