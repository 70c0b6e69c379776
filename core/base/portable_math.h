#pragma once

/// Functions of the C library's mathematics that samples depend on, made of operations whose
/// results IEEE 754 fixes: +, -, *, /, sqrt and scaling by powers of two. The C library chooses its
/// own by the processor, and their last bits differ; these give the same bits everywhere, where the
/// compiler does not contract operations (-ffp-contract=off). No errors; nothing depends on the
/// rounding mode being other than to nearest.
///
/// Reductions to small arguments by tables or periods, then Taylor series: Muller, Elementary
/// Functions, 3rd edition, chapters 4 and 11.
namespace ccst {

/// Angle of the vector (x, y) from the x axis [rad], in [-pi, pi]; signs of zeros and infinite
/// arguments as std::atan2(). Within 3 units in the last place.
double PortableAtan2(double y, double x);

/// Sine and cosine of `angle` [rad], within 2e-16 of the exact value for |angle| <= 1e5. Beyond, a
/// turn is taken for 2 pi rounded to a double. Not a number where the angle is not finite.
double PortableSin(double angle);
double PortableCos(double angle);

/// 2^x. Within 2 units in the last place; infinite above 1024, 0 below -1075.
double PortableExp2(double x);

/// Logarithm to base 2 of x > 0. Within 4e-16 of the exact value times its magnitude, or of 1.
double PortableLog2(double x);

/// x^y for x >= 0 and |y| <= 1000: within a relative error of 4e-16 (1 + |y log2(x)|); exactly 1
/// for y = 0, x for 1, x * x for 2, sqrt(x) for 0.5.
double PortablePow(double x, double y);

/// Length of (x, y), without overflow in between. Within 2 units in the last place.
double PortableHypot(double x, double y);

/// The smallest k with 2^k >= x, for finite x > 0. Exact.
int CeilLog2(double x);

}  // namespace ccst
