#!/usr/bin/python3
"""Prints the force density of parameters/verification/kelvin_voigt_manufactured.prm (needs sympy).

Motion x = X + (a A(t) sin(pi Y), a B(t) sin(pi X)), plane strain. Stress P = (tau + J sigma_v) F^{-T} with
  tau     = mu J^{-2/3} (b - tr b / 3 I) + kappa ln J I          uncoupled neo-Hookean (12), b = F F^T
  sigma_v = eta (L + c1 L^T + c2 tr L I),  L = F' F^{-1}         central c1 = c2 = 1; morris 0, 0; deviatoric 1, -2/3
and b = -Div P.
"""
import re

import sympy as s

# Shear p = dx/dY, q = dy/dX, their slopes py = dp/dY, qx = dq/dX, their rates dp, dq and slopes of rates dpy, dqx.
J, p, q, dp, dq, py, qx, dpy, dqx, mu, kappa, eta, c1, c2 = s.symbols("J p q dp dq py qx dpy dqx mu kappa eta c1 c2")
F = s.Matrix([[1, p, 0], [q, 1, 0], [0, 0, 1]])
inverse = s.Matrix([[1, -p, 0], [-q, 1, 0], [0, 0, J]]) / J
b = F * F.T
L = s.Matrix([[0, dp, 0], [dq, 0, 0], [0, 0, 0]]) * inverse
tau = mu * J**s.Rational(-2, 3) * (b - b.trace() / 3 * s.eye(3)) + kappa * s.log(J) * s.eye(3)
P = (tau + J * eta * (L + c1 * L.T + c2 * L.trace() * s.eye(3))) * inverse.T

TEXTS = {"J": "(1-p*q)", "p": "(a*pi*A*cos(pi*y))", "q": "(a*pi*B*cos(pi*x))", "dp": "(a*pi*dA*cos(pi*y))",
         "dq": "(a*pi*dB*cos(pi*x))", "py": "(-a*pi^2*A*sin(pi*y))", "qx": "(-a*pi^2*B*sin(pi*x))",
         "dpy": "(-a*pi^2*dA*sin(pi*y))", "dqx": "(-a*pi^2*dB*sin(pi*x))",
         "A": "(t+k*(1-cos(w*t)))", "dA": "(1+k*w*sin(w*t))", "B": "(-t+2*k*(1-cos(w*t)))", "dB": "(-1+2*k*w*sin(w*t))"}


def along_x(f):
    return s.diff(f, q) * qx + s.diff(f, dq) * dqx - s.diff(f, J) * p * qx


def along_y(f):
    return s.diff(f, p) * py + s.diff(f, dp) * dpy - s.diff(f, J) * q * py


def written_out(expression):
    text = re.sub(r"(\d+)/3\b", r"\1/3", str(expression)).replace("**", "^").replace(" ", "")
    for _ in range(3):
        text = re.sub(r"\b(" + "|".join(TEXTS) + r")\b", lambda name: TEXTS[name[0]], text)
    return text


if __name__ == "__main__":
    print(" ; \\\n      ".join(written_out(s.simplify(-along_x(P[i, 0]) - along_y(P[i, 1]))) for i in range(2)))
