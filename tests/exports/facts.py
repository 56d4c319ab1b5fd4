"""Facts about objects, as exports tell them: texts. A number is the shortest text that means it."""


def texts(attributes):
    """The struct `attributes` of a row, without what is not said."""
    return {key: _told(value) for key, value in attributes.items() if value is not None}


def _told(value):
    if isinstance(value, bool):
        return str(value).lower()
    return repr(value).removesuffix(".0") if isinstance(value, float) else str(value)
