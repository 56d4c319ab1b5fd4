"""The one exception that readers of a store must expect."""

from __future__ import annotations


class StoreError(Exception):
    """Something in a store is missing, broken or was never made.

    The message names what is wrong, where, and what to do; the parts are attributes, `None` where they do not apply.
    """

    def __init__(
        self,
        what: str,
        *,
        do: str,
        file: str | None = None,
        scene: int | None = None,
        frame: int | None = None,
        agent: str | None = None,
        sensor: str | None = None,
    ) -> None:
        self.what, self.do, self.file = what, do, file
        self.scene, self.frame, self.agent, self.sensor = scene, frame, agent, sensor
        super().__init__(what)

    def at(self, *, frame: int | None = None, agent: str | None = None, sensor: str | None = None) -> None:
        """Adds the parts of its place that were not known yet."""
        self.frame = frame if self.frame is None else self.frame
        self.agent = agent if self.agent is None else self.agent
        self.sensor = sensor if self.sensor is None else self.sensor

    def __str__(self) -> str:
        parts = {"scene": self.scene, "frame": self.frame, "agent": self.agent, "sensor": self.sensor}
        place = ", ".join(f"{name} {value}" for name, value in parts.items() if value is not None)
        file = f" [{self.file}]" if self.file else ""
        return f"{place + ': ' if place else ''}{self.what}{file}; {self.do}"

    def __reduce__(self) -> tuple[object, ...]:  # Workers hand exceptions over by pickling them.
        return (_rebuild, (dict(self.__dict__),))


def _rebuild(state: dict[str, object]) -> StoreError:
    error = StoreError.__new__(StoreError)
    Exception.__init__(error, state["what"])
    error.__dict__.update(state)
    return error
