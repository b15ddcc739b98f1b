#include "counter_model.hpp"

int main() { return check_models<copy_and_destroy<relacy_fetch_add_counter>>(); }
