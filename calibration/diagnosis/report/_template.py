"""Jinja2 template of the page."""

PAGE = """\
{% extends "frame" %}
{% from "parts" import table, figure %}
{% block title %}Diagnosis: {{ title }}{% endblock %}
{% block style %}
body { overflow-wrap: anywhere; } th, td { overflow-wrap: normal; max-width: 26rem; }
.verdict { border-left: 8px solid; padding: .8rem 1.2rem; margin: .4rem 0 1rem; font-size: 1.15rem; }
.verdict strong { display: block; font-size: .85rem; letter-spacing: .06em; text-transform: uppercase; }
.none { background: #E8F5EF; border-color: #009E73; } .none strong { color: #00694B; }
.found { background: #FDF1E6; border-color: #D55E00; } .found strong { color: #B34700; }
.ambiguous { background: #FDF7E3; border-color: #E69F00; } .ambiguous strong { color: #8A5A00; }
.partly { background: #FDF3EA; border-color: #CC79A7; } .partly strong { color: #8A1F5C; }
.unexplained { background: #F7EAF2; border-color: #A3286F; } .unexplained strong { color: #8A1F5C; }
.next { background: #EEF4FA; border-left: 4px solid #0072B2; padding: .5rem 1rem; margin: .8rem 0; }
{{ turned.style }}
{% endblock %}
{% block body %}
<h1>Diagnosis: {{ title }}</h1>
<p class="verdict {{ verdict }}"><strong>{{ headline }}</strong>
{{ sentence }}</p>
{% for p in shapes[:1] %}
{{ figure(p) }}
{% else %}
<p class="note">No pictures of shapes.</p>
{% endfor %}
{% for view, part in turned.sections.items() %}
<h3>{{ view.title }}</h3>
{{ part }}
{% endfor %}
{% if budget %}
<h2>Sources of the misfit</h2>
{{ table(budget_headings, budget) }}
{% endif %}
{% if alternatives | length > 1 %}
<h3>Equivalent explanations</h3>
{{ table(alternative_headings, alternatives) }}
{% endif %}
{% if next_experiment %}
<p class="next"><strong>Measure next:</strong> {{ next_experiment }}</p>
{% endif %}
{% for t in troubles %}
<p class="trouble">{{ t }}</p>
{% endfor %}
<section id="gain">
<h2>{{ "Measured against baseline and extended" if extended else "Measured against the baseline" }}</h2>
{% for p in shapes[1:] %}
{{ figure(p) }}
{% endfor %}
{{ table(fit_headings, fits) }}
{% if extended %}
<p class="note">The change of a modulus is the part of the cause that the baseline's fit had absorbed.
{{ gain }}</p>
{% endif %}
{% if folds %}
<h3>Predictions of each part from all others{{ "" if extended else ", with the nearest explanation" }}</h3>
{{ table(fold_headings, folds) }}
{% endif %}
{% for p in residuals %}
{{ figure(p) }}
{% endfor %}
</section>
{% if verdict in ("unexplained", "partly explained") %}
<section id="lack-of-fit">
<h2>{{ "Unexplained misfit" if verdict == "unexplained" else "Remaining misfit" }}</h2>
<p>{{ lack_of_fit }}</p>
{{ table(test_headings, tests) }}
</section>
{% endif %}
<section id="evidence">
<h2>Evidence, cause by cause</h2>
{{ figure(evidence) }}
<p class="note">{{ false_alarms }}</p>
</section>
<section id="invisible">
<h2>Effects not visible in this design</h2>
{% if invisible %}
<p>These effects would remain undetected, or be mistaken for others: their plausible amplitudes are below
those that these measurements would show at 5 standard deviations.</p>
{{ table(invisible_headings, invisible) }}
{% else %}
<p>None: each effect in the library would be visible at 5 standard deviations with a plausible amplitude.</p>
{% endif %}
</section>
{% if notes %}
<section id="notes">
<h2>Notes</h2>
<ul>{% for n in notes %}<li>{{ n }}</li>{% endfor %}</ul>
</section>
{% endif %}
<section id="method">
<h2>Method</h2>
{% for m in method %}
<p class="note">{{ m }}</p>
{% endfor %}
{% if verdict not in ("unexplained", "partly explained") %}
{{ table(test_headings, tests) }}
{% endif %}
</section>
{{ turned.script }}
{% endblock %}
"""
