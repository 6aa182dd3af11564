"""How the site is built: `make docs`."""

from __future__ import annotations

import ast
import importlib
import inspect
import logging
import os
import pkgutil
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

from _site import pages  # noqa: E402

import thermogear  # noqa: E402


def _names_of_types() -> None:
    """Give every module the names that it imports for type checkers alone: signatures need them."""
    found = pkgutil.walk_packages(thermogear.__path__, "thermogear.")
    names = [one.name for one in found if not one.name.endswith("__main__")]
    for module in [importlib.import_module(name) for name in names]:
        for part in ast.parse(inspect.getsource(module)).body:
            if isinstance(part, ast.If) and ast.unparse(part.test) == "TYPE_CHECKING":
                code = compile(ast.Module(part.body, []), module.__name__, "exec")
                exec(code, module.__dict__)


_names_of_types()

project = "thermogear"
author = "The thermogear developers"
copyright = author
release = version = thermogear.__version__

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.viewcode",
    "sphinx_click",
    "sphinx_copybutton",
    "_site.docstrings",
    "_site.mathml",
]
exclude_patterns = ["_build", "_site", "_static", "requirements.in", "jupyter_execute"]
default_role = "code"
templates_path: list[str] = []

# Nothing but trouble is told: not how a kernel is spoken to, not how many threads there are.
KERNEL = HERE / "_build" / "ipython" / "profile_default" / "ipython_kernel_config.py"
KERNEL.parent.mkdir(parents=True, exist_ok=True)
KERNEL.write_text("c.IPKernelApp.log_level = 40\n", "utf-8")
os.environ["IPYTHONDIR"] = str(KERNEL.parents[1])
for name in ("numexpr", "numexpr.utils", "traitlets"):
    logging.getLogger(name).setLevel(logging.WARNING)

# Pages made from data, before sphinx looks for its sources.
pages.write(HERE)

# ------------------------------------------------------------------ Markdown and notebooks
myst_enable_extensions = [
    "amsmath",
    "attrs_inline",
    "colon_fence",
    "deflist",
    "dollarmath",
    "substitution",
]
myst_substitutions = {"version": version}
myst_heading_anchors = 4
# Always executed, for the package may have changed under an unchanged notebook; an author who
# works on other pages may say THERMOGEAR_DOCS=cache.
nb_execution_mode = "cache" if os.environ.get("THERMOGEAR_DOCS") == "cache" else "force"
nb_execution_cache_path = str(HERE / "_build" / "notebooks")
nb_execution_raise_on_error = True
nb_execution_in_temp = True
nb_execution_timeout = 900
nb_execution_show_tb = True
nb_merge_streams = True
nb_mime_priority_overrides = [("html", "image/svg+xml", 0)]

# ---------------------------------------------------------------------------- Reference
viewcode_follow_imported_members = False
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_preserve_defaults = True
autodoc_type_aliases = {"ArrayLike": "ArrayLike", "Floats": "Floats"}
maximum_signature_line_length = 72
python_use_unqualified_type_names = True
add_module_names = False
toc_object_entries_show_parents = "hide"
nitpicky = True
# Names of other packages are not followed; every name of thermogear must lead somewhere, but for
# private ones (type variables) and the tables of the case file that are made while it is loaded.
nitpick_ignore_regex = [
    (r"py:.*", r"(?!thermogear\.).*"),
    (r"py:.*", r"thermogear\.(\w+\.)+_\w+"),
    (r"py:class", r"thermogear\.(study\.declared\.T|base\.kernel_cache\.(Kernel|Function))"),
    (r"py:.*", r"thermogear\.case\.friction_schema\.\w+Table"),
    (r"py:.*", r"thermogear\.case\.schema\.ModelTable"),
]
copybutton_exclude = ".linenos, .gp, .go"
copybutton_prompt_text = r"\$ |>>> "
copybutton_prompt_is_regexp = True

# --------------------------------------------------------------------------------- HTML
html_theme = "furo"
html_title = "thermogear"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_math_renderer = "mathml"
html_show_copyright = False
html_show_sphinx = False
html_copy_source = False
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#1f4e79", "color-brand-content": "#1f5f99"},
    "dark_css_variables": {"color-brand-primary": "#8fc1ea", "color-brand-content": "#8fc1ea"},
}
