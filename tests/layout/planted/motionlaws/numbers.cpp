// Neither a comment counts, nor 1e-9 in one.
constexpr double kFirst = 1, kSecond = 1e-3;
const double limit = 2.5;
const char* words = "1e-9";
/* nor
   1e-7 */
bool is_far(double x) { return x > 0.25 && x < 1e9 && x != 0.0001 && x >= 1.0; }
