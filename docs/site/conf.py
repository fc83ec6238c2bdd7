"""Sphinx settings of the documentation site; docs/site/make_site.py calls it."""

project = "hjcamp"
html_title = "hjcamp"
extensions = ["myst_parser"]
myst_heading_anchors = 3
html_theme = "furo"
html_show_sphinx = False
html_show_copyright = False
html_copy_source = False
html_show_sourcelink = False
pygments_dark_style = "monokai"
# Examples of output and of commands are no Python.
highlight_language = "text"
suppress_warnings = ["misc.highlighting_failure", "myst.header"]
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#0072b2", "color-brand-content": "#0072b2"},
    "dark_css_variables": {"color-brand-primary": "#56b4e9", "color-brand-content": "#56b4e9"},
}
