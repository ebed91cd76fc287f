# SPDX-License-Identifier: GPL-3.0-or-later
"""What was read before, kept as long as it is asked for and nothing that it was made from has changed.

A *token* is anything hashable that stands for what may change, say the uid of an object. A value depends on the tokens
named while it was made, and on the values that were asked for meanwhile; one that depends on neither follows from its
key and version alone.
"""

#: The token of what Blender does not report: such values are made anew at each read.
ALWAYS = "always"


class _Making:
    """A value in the making: the tokens and other values that it is made from, and what is reported meanwhile."""

    __slots__ = ("children", "messages", "tokens")

    def __init__(self):
        self.tokens, self.children, self.messages = set(), [], []


class _Entry:
    """A value, what it was made from, and the numbers of the reads that have `checked` it and `used` it last."""

    __slots__ = ("checked", "children", "messages", "stale", "tokens", "used", "value", "version")

    def __init__(self, value, version, making, read):
        self.value, self.version = value, version
        # Tuples, of which empty ones cost nothing: there may be a hundred thousand of these.
        self.tokens, self.children = tuple(making.tokens), tuple(making.children)
        self.messages = tuple(making.messages)
        self.checked = self.used = read
        self.stale = False


class Memory:
    """Values by key, over any number of reads; each read is between `begin` and `end`.

    A value that is taken from here says again what was reported when it was made.
    """

    def __init__(self, reports):
        self.reports = reports
        self._entries, self._open = {}, []
        self._read, self._changed, self._all = 1, frozenset(), False

    def begin(self, reports, changed=frozenset(), everything=False):
        """A read begins. `changed`: the tokens of what has changed since the one before; `everything` may have."""
        self.reports, self._changed, self._all = reports, {*changed, ALWAYS}, everything
        self._read += 1

    def end(self):
        """The read is over: what it did not ask for is forgotten."""
        if any(entry.used != self._read for entry in self._entries.values()):
            self._entries = {key: entry for key, entry in self._entries.items() if entry.used == self._read}

    def depend(self, *tokens):
        """What is being made depends on `tokens`."""
        if self._open:
            self._open[-1].tokens.update(tokens)

    def holds(self, key, version=None):
        """Whether `get` would make nothing."""
        entry = self._entries.get(key)
        return entry is not None and entry.version == version and not self._is_stale(entry)

    def last(self, key):
        """The value of a key, stale or not; None where there is none."""
        entry = self._entries.get(key)
        return None if entry is None else entry.value

    def get(self, key, make, version=None):
        """The value of a key, made by `make(previous)` where there is none of this `version` that still holds;
        `previous` is the value before, None at first: what comes out equal should be the same object again."""
        entry = self._entries.get(key)
        if entry is None or entry.version != version or self._is_stale(entry):
            entry = self._made(key, make, version, entry)
        else:
            self._use(entry)
        if self._open:
            self._open[-1].children.append(entry)
        return entry.value

    def _made(self, key, make, version, before):
        making = _Making()
        self._open.append(making)
        self.reports.record(making.messages)
        try:
            value = make(None if before is None else before.value)
        finally:
            self._open.pop()
            self.reports.end_record()
        if before is not None:  # whoever used it must look again
            before.stale, before.checked = True, self._read
        self._entries[key] = entry = _Entry(value, version, making, self._read)
        return entry

    def _is_stale(self, entry):
        if entry.checked != self._read:
            entry.checked = self._read
            entry.stale = (
                entry.stale
                or (self._all and bool(entry.tokens or entry.children))
                or not self._changed.isdisjoint(entry.tokens)
                or any(map(self._is_stale, entry.children))
            )
        return entry.stale

    def _use(self, entry):
        if entry.used != self._read:
            entry.used = self._read
            self.reports.repeat(entry.messages)
            for child in entry.children:
                self._use(child)
