"""Collision operators Q(f,f) behind one protocol."""

from granstudy.collision.operator import CollisionOperator, collision_operator, concrete

__all__ = ["CollisionOperator", "collision_operator", "concrete"]
