"""The errors a user can cause or meet. Everything else that is raised is a defect of Conic itself."""


class ConicError(Exception):
    """Base of what is shown to a user as a sentence, never as a traceback."""


class SceneError(ConicError):
    """A scene holds something that cannot be rendered; the message names it and says what to do."""


class StoppedError(ConicError):
    """Whoever asked for the work wants it no more."""


class DeviceError(ConicError):
    """No GPU context, a shader that does not compile, or memory that cannot be had; the message says which and why."""
