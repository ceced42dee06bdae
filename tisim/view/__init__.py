"""Results in three dimensions: one HTML page that opens from disk, in notebooks, as moving pictures.

>>> import tisim
>>> soft = tisim.material_from_moduli("neo-hookean", shear_modulus=15e3, bulk_modulus=300e3)
>>> beam = tisim.simulate(tisim.Beam(material=soft, length=0.05, radial_elements=1))
>>> shown = tisim.show(beam)
>>> shown.colourings[:2]
('displacement', 'von Mises stress')

`shown.save("beam.html")` writes the page, `shown.animate("beam.gif")` a moving picture, and a notebook shows
it by itself. Files are shown by `python -m tisim.view FILE`; `view_of_file` is the same from Python. Views of
one's own are made of `Surface`, `Field` and `Curve`; `tisim.view.page` puts them into other pages.
"""

import lazy_loader as _lazy

__getattr__, __dir__, __all__ = _lazy.attach_stub(__name__, __file__)
