// The mathematics, exceptions and streams of C++ beside the interface: prints the same with the library and without.
#include <cmath>
#include <cstdio>
#include <iostream>
#include <sstream>
#include <stdexcept>

#ifdef WITH_FGA
#include "fga.hpp"
#endif

namespace {

template <typename Number>
void print_all(Number x, Number y) {
  for (Number value : {std::sqrt(x), std::cbrt(x), std::fmod(y, x), std::fmax(x, y), std::fmin(x, y), std::floor(y), std::ceil(y),
                       std::trunc(y), std::rint(y), std::round(y), std::fma(x, y, x), std::fdim(y, x), std::copysign(x, -y),
                       std::fabs(-y), std::sin(x), std::pow(y, x), std::hypot(x, y)}) {
    std::printf("%a\n", static_cast<double>(value));
  }
}

}  // namespace

int main(int argc, char **) {
  print_all<float>(0.3F * static_cast<float>(argc), 7.25F);
  print_all<double>(0.3 * argc, 7.25);
  print_all<long double>(0.3L * argc, 7.25L);
  try {
    std::ostringstream text;
    text << "caught " << argc;
    throw std::runtime_error(text.str());
  } catch (const std::exception &error) {
    std::cout << error.what() << '\n';
  }
#ifdef WITH_FGA
  return fga_abi_version() != FGA_ABI_VERSION;
#else
  return 0;
#endif
}
