"""What all files that describe a rover have in common: findings about them, and what joints are called."""
