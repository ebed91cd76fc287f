# SPDX-License-Identifier: GPL-3.0-or-later
"""What the user can do with Conic: Add > Conic."""

from .add_shape import register, unregister

__all__ = ["register", "unregister"]
