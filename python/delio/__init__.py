"""LiDAR odometry and mapping.

Poses are (4, 4) arrays that map coordinates of the frame that they are named after to those of
their reference, in metres. Sensor and vehicle have x forward, y left, z up. Whatever cannot be done
raises delio.Error with one plain line.
"""

from ._delio import *
from ._delio import __version__ as __version__
