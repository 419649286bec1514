"""A run to look at in a browser: what is drawn as plain data, the script that draws it, the page.

:mod:`sandbox.show.parts` says what is drawn, :mod:`sandbox.show.channels` what changes of it
from sample to sample; the script in ``web/`` puts the one in the places that the other tells.
"""
