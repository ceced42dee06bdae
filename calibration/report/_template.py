"""HTML template of the page of a calibration (jinja2)."""

PAGE = """\
{% extends "frame" %}
{% from "parts" import table, figure %}
{% block title %}Calibration: {{ experiment.name }}{% endblock %}
{% block style %}
.verdict { background: #EEF4FA; border-left: 4px solid #0072B2; padding: .5rem 1rem; margin: .4rem 0; }
.good { color: #00694B; } .unseen { color: #5B6570; }
code, pre { font: .85rem ui-monospace, monospace; background: #F4F6F8; }
pre { padding: .6rem; overflow-x: auto; } code { overflow-wrap: anywhere; }
{{ turned.style }}
{% endblock %}
{% block body %}
<h1>Calibration: {{ experiment.name }}</h1>
{% for s in sections %}
<p class="{{ "trouble" if s.lacking else "verdict" }}">{{ s.verdict }}</p>
{% endfor %}
<p>{{ total }} fit{{ "s" if total > 1 }}: {{ counts }}.
± is one standard deviation, with the other constants and the nuisances free. A calibration takes the law,
the specimen, the rig and the camera as stated; <code>{{ diagnose }}</code> tests whether they are.</p>
{% for s in sections %}
<section id="{{ s.material }}">
<h2>{{ s.material }}</h2>
{% if s.troubles %}
<div class="trouble">
<strong>No calibration: {{ s.troubles | length }} of {{ s.laws | length }} fits</strong>
<ul>{% for t in s.troubles %}<li>{{ t }}</li>{% endfor %}</ul></div>
{% endif %}
<h3>Laws compared</h3>
{{ table(headings, s.laws) }}
<p class="note">{% if s.chosen %}{{ s.chosen.points }} points measured. {% endif %}
<a href="#reading">How to read this table.</a></p>
{% for n in s.notes %}
<p class="note">{{ n }}</p>
{% endfor %}
{% if s.parameters %}
{{ figure(s.parameters) }}
{% endif %}
{% if s.chosen and s.chosen.estimates or s.blind %}
<h3>Constants that the data do not determine</h3>
{% if s.blind or s.unidentified %}
<ul>{% for b in s.blind + s.unidentified %}<li>{{ b }}</li>{% endfor %}</ul>
{% else %}
<p>None: the data determine every constant of the laws fitted.</p>
{% endif %}
{% endif %}
{% if s.drawing_note %}
<p class="trouble">{{ s.drawing_note }}</p>
{% endif %}
{% if s.beams %}
<h3>Outlines, traced and simulated</h3>
{% if s.view is not none %}
<h4>{{ s.view.title }}</h4>
{{ turned.sections[s.view] }}
{% endif %}
{% for p in s.beams %}
{{ figure(p) }}
{% endfor %}
<h3>Residuals, photograph by photograph</h3>
{{ figure(s.residuals) }}
{% endif %}
{% if s.nuisances %}
<h3>Nuisances</h3>
{% if s.moved %}
<p>{{ s.moved | length }} of {{ s.nuisances }} beyond 2 standard deviations of what the lab states
({{ s.chosen.label }}); chance puts about one in twenty there.</p>
<table><thead><tr><th>nuisance</th><th>standard deviations</th><th>amount</th></tr></thead><tbody>
{% for m in s.moved %}
<tr><td>{{ m.name }}</td>
<td><data value="{{ m.sds }}">{{ "%+.1f" | format(m.sds) }}</data></td>
<td>{{ m.amount }}</td></tr>
{% endfor %}
</tbody></table>
{% else %}
<p>None of {{ s.nuisances }} nuisances (registration, section, length, density, mesh) lies beyond 2 standard
deviations of what the lab states.</p>
{% endif %}
{% endif %}
{% if s.held_out or s.held_out_notes %}
<h3>Held out: each beam predicted from the others</h3>
{% if s.held_out %}
{{ table(held_out_headings, s.held_out) }}
{% endif %}
{% for n in s.held_out_notes %}
<p class="note">{{ n }}</p>
{% endfor %}
{% if s.held_out_picture %}
{{ figure(s.held_out_picture) }}
{% endif %}
{% endif %}
{% if s.indentation_picture %}
<h3>Indentations, measured and simulated</h3>
{{ figure(s.indentation_picture) }}
{% endif %}
{% if s.coupon_picture %}
<h3>Homogeneous tests, measured and fitted</h3>
{{ figure(s.coupon_picture) }}
{{ table(s.coupon_headings, s.coupons) }}
<p class="note">rms of fitted minus measured stress over a curve's points, in percent of its largest
stress.</p>
{% endif %}
{% if s.ignored %}
<h3>Not used</h3>
<ul>{% for i in s.ignored %}<li>{{ i }}</li>{% endfor %}</ul>
{% endif %}
{% if s.chosen %}
<h3>Parameters of {{ s.chosen.label }} (SI, as <code>tisim.Material</code> takes them)</h3>
<pre>{% for k, v in s.chosen.parameters.items() %}{{ k }} = {{ v }}
{% endfor %}{% for k, v in s.chosen.material_parts.items() %}{{ k }} = {{ v }}
{% endfor %}</pre>
{% endif %}
</section>
{% endfor %}
<section id="reading">
<h2>How to read the tables</h2>
<p class="note">{{ rule }}</p>
<p class="note">"Not identified" stands in place of digits where the data do not settle a constant;
intervals in brackets are 95 %. Reduced χ²: squared misfit in units of the noise that the lab states, 1
where the law explains all but that noise; above 1 all error bars are widened by its root. rms: distance
between traced and simulated outline, registration and the other nuisances taken out. Held out: the same
for a beam predicted from all others. Candidates: materials that the search tried, and how many of them
had no equilibrium.</p>
</section>
<section id="origin">
<h2>Data and command</h2>
<p>Experiment <strong>{{ experiment.name }}</strong>:
{% for kind, n in kinds.items() %}{{ n }} {{ kind }}{{ "s" if n > 1 }}{{ ", " if not loop.last }}{% endfor %}
 in <code>{{ experiment.folder }}</code>, sha256 <code>{{ experiment.digest }}</code>.</p>
{% if experiment.notes %}
<p class="note">{{ experiment.notes }}</p>
{% endif %}
<p>To repeat:</p>
<pre>{{ repeat }}</pre>
</section>
{{ turned.script }}
{% endblock %}
"""
