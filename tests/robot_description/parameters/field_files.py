"""Reading and refusing a parameter file in a test."""

import pytest

from six_wheel.robot_description.parameters import ParameterFileError


def refusal(call, *arguments: object, **options: str) -> str:
    with pytest.raises(ParameterFileError) as caught:
        call(*arguments, **options)
    (line,) = str(caught.value).splitlines()
    return line
