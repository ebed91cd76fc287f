"""Which entry of the path tracer runs: its pixels are fragments that are drawn, or invocations of a compute program.

Both are the same text otherwise and give the same picture. Which one is faster depends on the device: some GPUs run
fragments on a part of their units only, others find what neighbours read again better among fragments.
"""

#: What can be asked for.
ENTRIES = ("AUTO", "FRAGMENT", "COMPUTE")
#: The file with main() of each.
FILES = {"FRAGMENT": "film_frag.glsl", "COMPUTE": "film_comp.glsl"}

_measured = {}  # what AUTO means, by the name of the device
_refused = set()  # devices whose driver did not take a compute program, by name


def known(device, wanted):
    """FRAGMENT or COMPUTE: what `wanted` means on a device, by what is known of it so far. It touches no GPU."""
    if wanted == "FRAGMENT" or not device.can_compute or device.name in _refused:
        return "FRAGMENT"
    return "COMPUTE" if wanted == "COMPUTE" else _measured.get(device.name, "FRAGMENT")


def refuse(device):
    """Its driver did not take a compute program: it gets no other one."""
    _refused.add(device.name)
