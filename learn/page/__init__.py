"""A live page of a surrogate: one HTML file in which one pokes the block (docs/how-to/live-page.md).

`graph` is what the browser runs, `content` what it shows, `document` the file; `js` has the script's
sources, `bundle` what they were built into.
"""
