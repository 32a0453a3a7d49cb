"""Collision operators Q(f,f) behind one protocol."""

from granstudy.collision.operator import CollisionOperator, collision_operator

__all__ = ["CollisionOperator", "collision_operator"]
