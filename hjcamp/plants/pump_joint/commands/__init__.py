"""Commands that are about this joint alone: ``hjcamp budget``, ``rig``, ``sizing`` and ``tour``."""
