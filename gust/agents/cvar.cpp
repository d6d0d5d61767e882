#include "gust/agents/cvar.h"

#include <boost/math/distributions/normal.hpp>

#include "gust/core/error.h"
#include "gust/core/math.h"

namespace gust {
namespace {

double normal_density(double z) {
  constexpr double kOneOverSqrtTwoPi = 0.3989422804014326779;
  return kOneOverSqrtTwoPi * exp(-0.5 * z * z);
}

}  // namespace

double cvar_coefficient(double alpha, CvarForm form) {
  GUST_CHECK(alpha > 0.0 && alpha <= 1.0);
  const boost::math::normal standard;
  if (form == CvarForm::kLiteral) return normal_density(alpha) / boost::math::cdf(standard, alpha);
  if (alpha == 1.0) return 0.0;  // where the quantile is infinite
  return normal_density(boost::math::quantile(standard, alpha)) / alpha;
}

}  // namespace gust
