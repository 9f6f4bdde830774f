"""Teaching: exercises with numbers of each student's own, their marking, and the lessons of the Learn page.

``exercises(student)`` gives a student's exercises, ``check(exercise, answer)`` says what is right or wrong with an
answer.
"""

from robomill.learn.exercise import Exercise, Slip
from robomill.learn.marking import Judgement, check
from robomill.learn.personal import exercise, exercises, load_tests

__all__ = ["Exercise", "Judgement", "Slip", "check", "exercise", "exercises", "load_tests"]
