"""Registration with Gymnasium: which environments there are, and where their classes lie."""

ENVIRONMENT_ID = "utak/Tabletop-v0"
WANTED = "the environment needs Gymnasium: pip install gymnasium"


def register_environments() -> None:
    """Make `utak/Tabletop-v0` known to Gymnasium; nothing happens when it is known already."""
    try:
        from gymnasium.envs.registration import register, registry
    except ImportError as missing:
        raise ImportError(WANTED) from missing
    if ENVIRONMENT_ID not in registry:
        register(ENVIRONMENT_ID, entry_point="utak.gym.environment:TabletopEnv")
