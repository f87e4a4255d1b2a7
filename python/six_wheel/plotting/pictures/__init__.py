"""Pictures of results that need nothing but the result, 7.2 in wide; `six_wheel.plot` chooses among them."""
