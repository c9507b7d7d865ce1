#!/usr/bin/python3
"""Prints the force density of parameters/verification/kelvin_voigt_manufactured.prm (needs sympy).

Motion x = X + A(t) w(X) e, w = sin(pi X) sin(pi Y), e = (1, 0), plane strain. With g = grad w
  F = I + A e g^T,  J = 1 + A e.g,  F^{-1} = I - A e g^T / J,  L = F' F^{-1} = A' e g^T / J,
and the stress P = (tau + J sigma_v) F^{-T}, where
  tau     = mu J^{-2/3} (b - tr b / 3 I) + kappa ln J I          uncoupled neo-Hookean (12), b = F F^T
  sigma_v = eta (L + c1 L^T + c2 tr L I)                         central c1 = c2 = 1; morris 0, 0; deviatoric 1, -2/3
The force density is -Div P.
"""
import re

import sympy as s

# Slopes gx, gy of w, second slopes h = w_xx = w_yy and m = w_xy; dA = A'.
A, dA, gx, gy, h, m, J, mu, kappa, eta, c1, c2 = s.symbols("A dA gx gy h m J mu kappa eta c1 c2")
e, g = s.Matrix([1, 0, 0]), s.Matrix([gx, gy, 0])
F = s.eye(3) + A * e * g.T
b = F * F.T
tau = mu * J**s.Rational(-2, 3) * (b - b.trace() / 3 * s.eye(3)) + kappa * s.log(J) * s.eye(3)
viscous = eta * dA * (e * g.T + c1 * g * e.T + c2 * e.dot(g) * s.eye(3))
P = (tau + viscous) * (s.eye(3) - A * g * e.T / J)

TEXTS = {"A": "(a*(t+k*(1-cos(f*t))))", "dA": "(a*(1+k*f*sin(f*t)))",
         "gx": "(pi*cos(pi*x)*sin(pi*y))", "gy": "(pi*sin(pi*x)*cos(pi*y))",
         "h": "(-pi^2*sin(pi*x)*sin(pi*y))", "m": "(pi^2*cos(pi*x)*cos(pi*y))", "J": "(1+A*gx)"}


def slope(P, gx_slope, gy_slope):
    return s.diff(P, gx) * gx_slope + s.diff(P, gy) * gy_slope + s.diff(P, J) * A * gx_slope


def written_out(expression):
    text = str(expression).replace("**", "^").replace(" ", "")
    for _ in range(2):
        text = re.sub(r"\b(" + "|".join(TEXTS) + r")\b", lambda name: TEXTS[name[0]], text)
    return text


if __name__ == "__main__":
    print(" ; \\\n      ".join(written_out(s.factor_terms(-slope(P[i, 0], h, m) - slope(P[i, 1], m, h))) for i in range(2)))
