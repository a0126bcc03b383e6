"""LiDAR odometry and mapping in Python: see https://... (share/doc/method/python.md)."""

from ._delio import *
from ._delio import Error, __version__
