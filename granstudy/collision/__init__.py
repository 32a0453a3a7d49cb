"""Collision operators Q(f,f) behind one protocol, a folder or file for each method."""

from granstudy.collision.operator import collision_operator, concrete
from granstudy.collision.protocol import CollisionOperator

__all__ = ["CollisionOperator", "collision_operator", "concrete"]
