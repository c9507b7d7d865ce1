"""Uniform stress [Pa] of the laws of the evidence in plane strain, by Young's modulus, Poisson's ratio and the motion."""
import math


def moduli(E, nu):
    """Shear and bulk modulus [Pa]."""
    return E / (2 * (1 + nu)), E / (3 * (1 - 2 * nu))


def stretched(is_rate, E, nu, stretch):
    """(sigma_xx, sigma_yy, sigma_zz, sigma_xy) of F = diag(1, stretch): neo-Hookean, or of the rate form (hypoelastic)."""
    mu, kappa = moduli(E, nu)
    J = stretch
    if is_rate:
        S, p = 2. / 3 * mu * math.log(J), kappa * (1 / J - 1)
        return -S - p, 2 * S - p, -S - p, 0.
    s = mu * J**(-5. / 3)
    third = (2 + J**2) / 3
    mean = kappa * math.log(J) / J
    return s * (1 - third) + mean, s * (J**2 - third) + mean, s * (1 - third) + mean, 0.


def sheared(is_rate, E, nu, shear):
    """The same of F = I + shear e_x e_y, of particles by the logarithmic strain, which their stresses are drawn to."""
    mu, _ = moduli(E, nu)
    if is_rate:
        stretch = (shear + math.sqrt(shear**2 + 4)) / 2
        angle = math.atan2(1, stretch)  # of the long axis to x
        size = 2 * mu * math.log(stretch)
        return size * math.cos(2 * angle), -size * math.cos(2 * angle), 0., size * math.sin(2 * angle)
    return mu * 2 * shear**2 / 3, -mu * shear**2 / 3, -mu * shear**2 / 3, mu * shear


def von_mises(sigma):
    xx, yy, zz, xy = sigma
    return math.sqrt(.5 * ((xx - yy)**2 + (yy - zz)**2 + (zz - xx)**2) + 3 * xy**2)
