"""The kernel's text with marks (@NAME@) where the effects' code goes. Read it beside affine_model.dynamics."""

from affine_model.kernel.template.motion import MOTION
from affine_model.kernel.template.outcome import OUTCOME
from affine_model.kernel.template.solution import SOLUTION
from affine_model.kernel.template.start import START

TEMPLATE = START + MOTION + SOLUTION + OUTCOME
