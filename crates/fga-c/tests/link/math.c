// Calls every function of math.h, in the three precisions, and the interface where it is linked: prints the same with the library
// and without.
#include <math.h>
#include <stdio.h>
#include <string.h>

#ifdef WITH_FGA
#include "fga.h"
#endif

// Arguments that no compiler knows: every call is made.
static volatile double given[] = {0.3, -0.7, 1.5, 2.5, 7.25, 40.0};
static volatile int power = 3;

static void print(const char *name, double value) {
  unsigned long long bits;
  memcpy(&bits, &value, sizeof bits);
  printf("%s %016llx\n", name, bits);
}

#define EACH_OF_ONE(DO) \
  DO(acos) DO(asin) DO(atan) DO(cos) DO(sin) DO(tan) DO(acosh) DO(asinh) DO(atanh) DO(cosh) DO(sinh) DO(tanh) \
  DO(exp) DO(exp2) DO(expm1) DO(log) DO(log10) DO(log1p) DO(log2) DO(logb) DO(cbrt) DO(fabs) DO(sqrt) \
  DO(erf) DO(erfc) DO(lgamma) DO(tgamma) DO(ceil) DO(floor) DO(nearbyint) DO(rint) DO(round) DO(trunc)
#define EACH_TO_INTEGER(DO) DO(lrint) DO(lround) DO(llrint) DO(llround) DO(ilogb)
#define EACH_OF_TWO(DO) \
  DO(atan2) DO(hypot) DO(pow) DO(fmod) DO(remainder) DO(copysign) DO(nextafter) DO(fdim) DO(fmax) DO(fmin)

#define OF_ONE(name) \
  print(#name, name(x)); \
  print(#name "f", (double)name##f((float)x)); \
  print(#name "l", (double)name##l((long double)x));
#define TO_INTEGER(name) \
  print(#name, (double)name(x)); \
  print(#name "f", (double)name##f((float)x)); \
  print(#name "l", (double)name##l((long double)x));
#define OF_TWO(name) \
  print(#name, name(x, y)); \
  print(#name "f", (double)name##f((float)x, (float)y)); \
  print(#name "l", (double)name##l((long double)x, (long double)y));

int main(void) {
  for (size_t at = 0; at + 1 < sizeof given / sizeof *given; ++at) {
    double x = given[at], y = given[at + 1], whole;
    float whole_f;
    long double whole_l;
    int found;
    EACH_OF_ONE(OF_ONE)
    EACH_TO_INTEGER(TO_INTEGER)
    EACH_OF_TWO(OF_TWO)
    print("fma", fma(x, y, x));
    print("fmaf", (double)fmaf((float)x, (float)y, (float)x));
    print("fmal", (double)fmal((long double)x, (long double)y, (long double)x));
    print("nexttoward", nexttoward(x, (long double)y));
    print("nexttowardf", (double)nexttowardf((float)x, (long double)y));
    print("nexttowardl", (double)nexttowardl((long double)x, (long double)y));
    print("ldexp", ldexp(x, power));
    print("ldexpf", (double)ldexpf((float)x, power));
    print("ldexpl", (double)ldexpl((long double)x, power));
    print("scalbn", scalbn(x, power));
    print("scalbnf", (double)scalbnf((float)x, power));
    print("scalbnl", (double)scalbnl((long double)x, power));
    print("scalbln", scalbln(x, power));
    print("scalblnf", (double)scalblnf((float)x, power));
    print("scalblnl", (double)scalblnl((long double)x, power));
    print("frexp", frexp(x, &found) + found);
    print("frexpf", (double)frexpf((float)x, &found) + found);
    print("frexpl", (double)frexpl((long double)x, &found) + found);
    print("modf", modf(x, &whole) + 2.0 * whole);
    print("modff", (double)modff((float)x, &whole_f) + 2.0 * (double)whole_f);
    print("modfl", (double)modfl((long double)x, &whole_l) + 2.0 * (double)whole_l);
    print("remquo", remquo(x, y, &found) + (found & 7));
    print("remquof", (double)remquof((float)x, (float)y, &found) + (found & 7));
    print("remquol", (double)remquol((long double)x, (long double)y, &found) + (found & 7));
    print("nan", fabs(nan("")));
    print("nanf", (double)fabsf(nanf("")));
    print("nanl", (double)fabsl(nanl("")));
  }
#ifdef WITH_FGA
  // Every function of the interface that takes nothing, or nothing that must be there.
  fga_vehicle vehicle = {.size = sizeof vehicle};
  fga_refusal why = {.size = sizeof why};
  return fga_abi_version() != FGA_ABI_VERSION || fga_avoider_size(16, 32) != FGA_AVOIDER_BYTES(16, 32) ||
         fga_vehicle_from_bank(given[5], given[0], &vehicle, &why) != FGA_STATUS_OK;
#else
  return 0;
#endif
}
