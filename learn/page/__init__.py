"""Live page of a surrogate: one HTML file in which users poke the block (docs/how-to/live-page.md).

`graph` is the computation that the browser runs, `content` the data that it shows, `document` the file; `js`
has the script's sources, `bundle` the built script.
"""
