#include "counter_model.hpp"

int main() { return check_models<copy_and_destroy<relacy_cas_counter>>(); }
