"""Results in three dimensions: a single HTML page that opens from disk, notebooks, and animations.

>>> import tisim
>>> soft = tisim.material_from_moduli("neo-hookean", shear_modulus=15e3, bulk_modulus=300e3)
>>> beam = tisim.simulate(tisim.Beam(material=soft, length=0.05, radial_elements=1))
>>> shown = tisim.show(beam)
>>> shown.colourings[:2]
('displacement', 'von Mises stress')

`shown.save("beam.html")` writes the page, `shown.animate("beam.gif")` an animation, and a notebook displays
the view. `python -m tisim.view FILE` shows files; `view_of_file` does so from Python. Users can compose their
own views from `Surface`, `Field` and `Curve`; `tisim.view.page` embeds them in other pages.
"""

import lazy_loader as _lazy

__getattr__, __dir__, __all__ = _lazy.attach_stub(__name__, __file__)
