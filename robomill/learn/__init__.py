"""Teaching: exercises with numbers of each student's own, their marking, and the lessons of the Learn page.

``exercises(student)`` gives a student's exercises, ``check(exercise, answer)`` says what is right or wrong with an
answer, ``answers_text`` is the file of a student's answers, ``grade(folder)`` marks those of a class.
"""

from robomill.learn.answers import answers_text
from robomill.learn.exercise import Exercise, Slip
from robomill.learn.grading import Marks, grade
from robomill.learn.marking import Judgement, check
from robomill.learn.personal import exercise, exercises, load_tests

__all__ = [
    "Exercise",
    "Judgement",
    "Marks",
    "Slip",
    "answers_text",
    "check",
    "exercise",
    "exercises",
    "grade",
    "load_tests",
]
